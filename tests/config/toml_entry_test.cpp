#include <breakwater/config/toml_entry.h>

#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <breakwater/config/fields.h>

namespace breakwater {
namespace {

enum class Colour { red, green };
const Names<Colour> kColours = {{"red", Colour::red}, {"green", Colour::green}};

constexpr const char* kTables = R"(name = ""
count = 1.5
[wall]
place = [1, "two"]
speed = -1
colour = "gren"
[wall.part]
)";

TEST(TomlEntry, MessagesNamePlaceAndReason) {
  const toml::table tables = toml::parse(kTables, std::string_view("a.toml"));
  struct Row {
    std::function<void(const TomlEntry& root)> read;
    std::string message;
  };
  const std::vector<Row> rows = {
      {[](const auto& e) { (void)e["name"].text(); }, "a.toml:1: name: must be a text, is empty"},
      {[](const auto& e) { (void)e["nam"].text(); }, "a.toml: nam: is missing"},
      {[](const auto& e) { (void)e["count"].text(); }, "a.toml:2: count: must be a text"},
      {[](const auto& e) { (void)e["count"].whole(1, 9); },
       "a.toml:2: count: must be a whole number of 1 to 9"},
      {[](const auto& e) { (void)e["count"]["x"]; }, "a.toml:2: count: must be a table"},
      {[](const auto& e) { (void)e["count"].elements(); }, "a.toml:2: count: must be an array"},
      {[](const auto& e) { (void)e["wall"]["width"].number(); },
       "a.toml:3: wall.width: is missing"},
      {[](const auto& e) { (void)e["door"]["width"].number(); }, "a.toml: door.width: is missing"},
      {[](const auto& e) { (void)e["name"].text_or_nothing(); },
       "a.toml:1: name: must be a text, is empty"},
      {[](const auto& e) { (void)e["count"].text_or_empty(); }, "a.toml:2: count: must be a text"},
      {[](const auto& e) { (void)e["wall"]["place"].elements()[1].number(); },
       "a.toml:4: wall.place: must be a number"},
      {[](const auto& e) { (void)e["wall"]["place"].texts(); },
       "a.toml:4: wall.place: must be a text"},
      {[](const auto& e) { (void)e["wall"]["speed"].number(positive()); },
       "a.toml:5: wall.speed: must be positive, is -1"},
      {[](const auto& e) { (void)e["wall"]["colour"].choice(kColours); },
       "a.toml:6: wall.colour: must be one of red, green, is \"gren\" (did you mean green?)"},
      {[](const auto& e) { (void)e["wall"]["part"].written(); },
       "a.toml:7: wall.part: must be a number, a text, true, false or an array of these"},
      {[](const auto& e) {
         e["wall"].allow({"place", "speed", "color", "part"});
       },
       "a.toml:6: wall.colour: unknown key (did you mean color?)"}};
  for (const Row& row : rows) {
    try {
      row.read(TomlEntry(tables, "a.toml"));
      ADD_FAILURE() << row.message;
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(error.what(), row.message);
    }
  }
}

TEST(TomlEntry, ReadsInTheOrderOfTheFileAndAcceptsAMissingEntry) {
  const toml::table tables = toml::parse(kTables, std::string_view("a.toml"));
  const TomlEntry root(tables, "a.toml");
  std::vector<std::string> keys;
  for (const auto& [key, entry] : root["wall"].entries()) keys.push_back(key);
  EXPECT_EQ(keys, (std::vector<std::string>{"place", "speed", "colour", "part"}));
  EXPECT_EQ(root["wall"]["place"].written(), "[1, \"two\"]");
  EXPECT_FALSE(root["door"]["width"]);
  EXPECT_TRUE(root["door"].entries().empty());
  EXPECT_TRUE(root["door"]["width"].texts().empty());
  EXPECT_EQ(root["door"].text_or_nothing(), "");
  EXPECT_EQ(root["name"].text_or_empty(), "");
  EXPECT_EQ(root["door"].number_or_nothing(), std::nullopt);
}

}  // namespace
}  // namespace breakwater
