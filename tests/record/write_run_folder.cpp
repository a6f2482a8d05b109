// write_run_folder TARGET CONTENT: writes a run's folder like a run.
#include <cstdio>
#include <exception>

#include <breakwater/record/run_folder.h>
#include <breakwater/record/text_outputs.h>

int main(int, char** argv) {
  try {
    breakwater::RunFolder folder(argv[1]);
    const std::string path = folder.path().string();
    breakwater::write_text_file(path + "/manifest.json", R"({"scenario": "s", "state_hash": "0"})");
    breakwater::write_text_file(path + "/log.csv", argv[2]);
    folder.commit();
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
