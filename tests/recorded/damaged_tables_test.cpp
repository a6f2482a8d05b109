// Tables with the damages of real laboratories: what is repaired, and what is refused.
#include <fmt/format.h>

#include <breakwater/recorded/recorded_axis.h>
#include "support.h"
#include "tables.h"

namespace breakwater::damaged_tables_test {

using Lines = std::vector<std::string>;

// 40 rows of a ramp: time k/100 s, input k, position 2 k.
Lines whole_table(char separator = ',') {
  Lines lines = {fmt::format("time_s{0}u{0}y", separator)};
  for (int k = 0; k < 40; ++k) {
    lines.push_back(fmt::format("{1:.2f}{0}{2}{0}{3}", separator, 0.01 * k, k, 2 * k));
  }
  return lines;
}

std::string joined(const Lines& lines) {
  return fmt::format("{}\n", fmt::join(lines, "\n"));
}

struct Damage {
  std::string name;
  std::function<void(Lines&)> apply;
  std::string report;       // the repairs, or the message without the name of the file
  std::size_t rows = 40;    // that are left; 0: refused
  bool same_values = true;  // the rows lie on the ramp
  char separator = ',';
};

// The damages that are not in texts.txt.
const std::vector<Damage> kDamages = {
    {"windows_ends",
     [](Lines& l) {
       for (std::string& line : l) line += "\r";
       l[0].insert(0, "\xef\xbb\xbf");
     },
     ""},
    {"decimal_commas",
     [](Lines& l) {
       for (std::string& line : l) std::replace(line.begin(), line.end(), '.', ',');
     },
     "", 40, true, ';'},
    {"second_record",
     [](Lines& l) {
       const Lines again(l.begin() + 1, l.end());
       l.insert(l.end(), again.begin(), again.end());
     },
     "42: time_s: goes back by more than 8 rows: is this a second record?", 0},
    {"wide_text", [](Lines& l) { l[0].insert(0, "\xff\xfe"); },
     "1: the text is in UTF-16: save it as UTF-8", 0},
};

// The row k of a template.
std::string row_of(const std::string& text, int k) {
  using fmt::arg;
  return fmt::format(fmt::runtime(text), arg("k", k), arg("y", 2 * k), arg("ms", 10 * k),
                     arg("t", fmt::format("{:.2f}", 0.01 * k)), arg("m", 1000 * k),
                     arg("slow", fmt::format("{:.2f}", 0.04 * (k / 4))), arg("word", 2 * k - 65536),
                     arg("turn", 2 * k - 360), arg("reset", 2 * k - 60));
}

// "LINE: text" replaces a line. "+LINE: text" inserts one. "-LINE: n" takes n away. "rows: text" is
// a template for all rows, "late: text" for the rows from 30 on. "most: text" is for three of four.
void damage_by(Lines& lines, const std::string& what, const std::string& text) {
  if (what == "rows" || what == "late" || what == "most") {
    for (int k = what == "late" ? 30 : 0; k < 40; ++k) {
      if (what != "most" || k % 4 != 0) {
        lines.at(static_cast<std::size_t>(k) + 1) = row_of(text, k);
      }
    }
    return;
  }
  const auto line = lines.begin() + std::abs(std::stoi(what)) - 1;
  if (what[0] == '+') {
    lines.insert(line, text);
  } else if (what[0] == '-') {
    lines.erase(line, line + std::stoi(text));
  } else {
    *line = text;
  }
}

std::vector<Damage> all_damages() {
  std::vector<Damage> all = kDamages;
  for (const auto& row : testing::rows_of("DamagedTables")) {
    const auto apply = [changes = row.at(1)](Lines& lines) {
      for (std::size_t at = 0; at < changes.size();) {
        const std::size_t colon = changes.find(": ", at);
        const std::size_t end = std::min(changes.find("; ", at), changes.size());
        damage_by(lines, changes.substr(at, colon - at),
                  changes.substr(colon + 2, end - colon - 2));
        at = end + 2;
      }
    };
    all.push_back({row.at(0), apply, row.at(2), std::stoul(row.at(3)), row.at(4) == "same"});
  }
  return all;
}

class DamagedTable : public ::testing::TestWithParam<Damage> {};

TEST_P(DamagedTable, IsRepairedAndCountedOrRefusedWithItsLine) {
  const Damage& damage = GetParam();
  Lines lines = whole_table(damage.separator);
  damage.apply(lines);
  const testing::TemporaryPath file("damaged.csv");
  std::ofstream(file, std::ios::binary) << joined(lines);
  RecordedAxis axis;
  try {
    axis = read_recorded_axis(file.string());
  } catch (const std::invalid_argument& error) {
    EXPECT_EQ(error.what(), file.string() + ":" + damage.report);
    EXPECT_EQ(damage.rows, 0U) << error.what();
    return;
  }
  EXPECT_EQ(fmt::format("{}", fmt::join(axis.repairs, "; ")), damage.report);
  ASSERT_EQ(axis.times_s.size(), damage.rows);
  for (std::size_t k = 0; k < damage.rows; ++k) {
    EXPECT_TRUE(k == 0 || axis.times_s[k] > axis.times_s[k - 1]);
    if (!damage.same_values) continue;
    EXPECT_NEAR(axis.inputs[k], 100.0 * axis.times_s[k], 1e-9) << k;
    EXPECT_NEAR(axis.positions[k], 200.0 * axis.times_s[k], 1e-9) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(All, DamagedTable, ::testing::ValuesIn(all_damages()),
                         [](const auto& damage) { return damage.param.name; });

double wrapped(double position, double low, double range) {
  return position - range * std::floor((position - low) / range);
}

// A motion, the counter that shows it, and what is said of it. Afterwards the position is the
// motion plus a constant within `error`, or else the counter's own.
struct Counter {
  std::string name;
  double (*motion)(int k);
  double (*shown)(int k, double position);
  std::string report;
  double error = 1e-9;
  bool is_repaired = true;
};

double steady(int k) {
  return 5.0 * k;
}
double uneven(int k) {
  return std::round(5.0 * k + 40.0 * std::sin(0.1 * k));
}
double there_and_back(int k) {
  return std::round(260.0 * (1.0 - std::cos(0.03 * k)));
}
double stands_and_goes(int k) {
  return k < 320 ? std::min(5.0 * k, 400.0) : 400.0 + 5.0 * (k - 320);
}

const std::vector<Counter> kCounters = {
    {"wraps", uneven, [](int, double p) { return wrapped(p, 0.0, 400.0); },
     "5 wraps of a counter of 400 unwrapped (the first in line 76)"},
    {"wraps_of_any_range", steady, [](int, double p) { return wrapped(p, -20.0, 387.0); },
     "5 wraps of a counter of 387 unwrapped (the first in line 76)"},
    {"wraps_with_both_ends", [](int k) { return 3.6 * k; },
     [](int k, double p) { return k == 150 ? 180.0 : wrapped(p, -180.0, 360.0); },
     "4 wraps of a counter of 360 unwrapped (the first in line 52)"},
    {"wraps_of_a_slow_counter", [](int k) { return std::round(0.1 * k) + 380.0 + k % 2; },
     [](int, double p) { return wrapped(p, 0.0, 400.0); },
     "11 wraps of a counter of 400 unwrapped (the first in line 187)"},
    {"resets_at_unlike_positions", steady,
     [](int k, double p) {
       return p - (k < 80 ? 0.0 : k < 110 ? 400.0 : 550.0);
     },
     "2 resets of the counter to 0 undone (the first in line 82)"},
    {"resets_at_like_positions", steady,
     [](int k, double p) {
       return p - (k < 80 ? 0.0 : k < 158 ? 400.0 : k < 239 ? 790.0 : 1195.0);
     },
     "3 resets of the counter to 0 undone (the first in line 82)"},
    {"reset_near_a_round_number", steady, [](int k, double p) { return k < 81 ? p : p - 405.0; },
     "1 reset of the counter to 0 undone (in line 83)"},
    {"reset_on_the_way_back", there_and_back,
     [](int k, double p) { return k < 138 ? p : p - there_and_back(138); },
     "1 reset of the counter to 0 undone (in line 140)", 2.0},
    {"reset_at_rest", stands_and_goes, [](int k, double p) { return k < 150 ? p : p - 400.0; },
     "1 reset of the counter to 0 undone (in line 152)"},
    {"jumps_to_unlike_positions", steady,
     [](int k, double p) { return p - (k < 80    ? 0.0
                                       : k < 110 ? 300.0
                                                 : 500.0); }, "", 1e-9, false},
};

class CounterOfATable : public ::testing::TestWithParam<Counter> {};

TEST_P(CounterOfATable, IsTakenForAWrapOnlyIfItIsOne) {
  const Counter& counter = GetParam();
  const testing::TemporaryPath file("counter.csv");
  std::vector<double> motion, shown;
  std::ofstream out(file);
  out << "time_s,u,y\n";
  for (int k = 0; k < 400; ++k) {
    motion.push_back(counter.motion(k));
    shown.push_back(counter.shown(k, motion.back()));
    out << fmt::format("{:.2f},1,{:.10g}\n", 0.01 * k, shown.back());
  }
  out.close();
  const RecordedAxis axis = read_recorded_axis(file.string());
  EXPECT_EQ(fmt::format("{}", fmt::join(axis.repairs, "; ")), counter.report);
  const std::vector<double>& expected = counter.is_repaired ? motion : shown;
  ASSERT_EQ(axis.positions.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    ASSERT_NEAR(axis.positions[k] - axis.positions[0], expected[k] - expected[0], counter.error)
        << k;
  }
}

INSTANTIATE_TEST_SUITE_P(All, CounterOfATable, ::testing::ValuesIn(kCounters),
                         [](const auto& counter) { return counter.param.name; });

TEST(DamagedTables, InputsOfALowerRateAreHeldAndThoseOfAHigherRateAveraged) {
  const testing::TemporaryPath file("rates.csv");
  std::ofstream(file) << "time_s,u,y\n0,1,0\n1,,1\n2,,2\n3,4,3\n";
  EXPECT_EQ(read_recorded_axis(file.string()).inputs, (std::vector<double>{1, 1, 1, 4}));
  std::ofstream(file) << "time_s,u,y\n0,1,0\n1,2,\n2,6,\n3,4,3\n4,4,4\n";
  EXPECT_EQ(read_recorded_axis(file.string()).inputs, (std::vector<double>{3, 4, 4}));
}

TEST(EncoderQuantum, IsFoundInPrintedDigitsAndNotInAnalogPositions) {
  constexpr double quantum = 2.0 * std::numbers::pi / 4096.0;
  std::vector<double> printed;
  std::vector<double> analog;
  std::vector<double> sparse;  // in steps of two and three counts
  for (int k = 0; k < 500; ++k) {
    const double q = 3.0 * std::sin(0.01 * k);
    printed.push_back(std::round(quantum * std::round(q / quantum) * 1e6) / 1e6);
    analog.push_back(q);
    sparse.push_back(quantum * (k % 2 == 0 ? 2.5 * k : 2.5 * k - 0.5));
  }
  EXPECT_NEAR(encoder_quantum(printed), quantum, 1e-9);
  EXPECT_NEAR(encoder_quantum(sparse), quantum, 1e-12);
  // So fast that each row is many counts from the last one.
  std::vector<double> fast;
  for (int k = 0; k < 500; ++k) {
    const double q = 0.1 * k + std::sin(0.05 * k);
    fast.push_back(std::round(quantum * std::round(q / quantum) * 1e6) / 1e6);
  }
  EXPECT_NEAR(encoder_quantum(fast), quantum, 1e-9);
  EXPECT_EQ(encoder_quantum(analog), 0.0);
  EXPECT_EQ(encoder_quantum(std::vector<double>{1.0, 1.0}), 0.0);
}

}  // namespace breakwater::damaged_tables_test
