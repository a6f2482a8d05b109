#include <breakwater/cluster/slurm_answers.h>

#include <algorithm>
#include <charconv>
#include <stdexcept>

namespace breakwater {

std::vector<QueuedTask> queued_tasks(const std::vector<std::string>& lines) {
  std::vector<QueuedTask> tasks;
  for (const std::string& line : lines) {
    std::vector<std::string> parts;
    for (std::size_t at = 0; at <= line.size();) {
      const std::size_t end = std::min(line.find('|', at), line.size());
      parts.push_back(line.substr(at, end - at));
      at = end + 1;
    }
    QueuedTask task;
    if (parts.size() != 4) continue;
    // The user may have jobs that are no arrays. Their index is N/A.
    const char* const end = parts[1].data() + parts[1].size();
    if (std::from_chars(parts[1].data(), end, task.index).ptr != end || task.index == 0) continue;
    task.job = parts[0];
    task.state = parts[2];
    if (task.state == "PENDING" && parts[3] != "None") task.reason = parts[3];
    tasks.push_back(task);
  }
  return tasks;
}

std::size_t slurm_limit(const std::vector<std::string>& lines, const std::string& name) {
  for (const std::string& line : lines) {
    if (!line.starts_with(name)) continue;
    const std::size_t at = std::min(line.find_first_of("0123456789", name.size()), line.size());
    std::size_t limit = 0;
    std::from_chars(line.data() + at, line.data() + line.size(), limit);
    if (limit > 0) return limit;
  }
  throw std::invalid_argument("scontrol show config: has no " + name + " above 0");
}

std::string accepted_job(const std::vector<std::string>& lines,
                         std::vector<std::string>& warnings) {
  for (const std::string& line : lines) {
    std::string job = line.substr(0, line.find(';'));
    if (!job.empty() && job.find_first_not_of("0123456789") == std::string::npos) return job;
    warnings.push_back(line);
  }
  throw std::invalid_argument("sbatch: has named no job");
}

}  // namespace breakwater
