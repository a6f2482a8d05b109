// Records of an axis, and those with irregular times.
#include <breakwater/experiment/runner.h>
#include <breakwater/recorded/recorded_axis.h>
#include <breakwater/recorded/recorded_estimation.h>
#include "support.h"

namespace breakwater::irregular_record_test {

constexpr double kPeriod = 5e-4;
constexpr double kDuration = 4.0;
constexpr double kStep = 1.0;  // time of the load step
constexpr double kLoad = 0.05;
constexpr double kInertia = 1e-3;
constexpr double kFriction = 2e-4;
constexpr double kQuantum = 2.0 * std::numbers::pi / 65536.0;

struct Row {
  double time_s, u, q, d;
};

// A servo follows 2 sin 2t. It samples and holds at these times.
std::vector<Row> moved_motor(const std::vector<double>& instants) {
  constexpr double a = kFriction / kInertia;
  double q = 0.0;
  double v = 0.0;
  const auto move = [&](double h, double force) {
    const double end = force / kFriction;
    const double decay = std::exp(-a * h);
    q += end * h + (v - end) * (1.0 - decay) / a;
    v = end + (v - end) * decay;
  };
  std::vector<Row> rows;
  for (std::size_t k = 0; k < instants.size(); ++k) {
    const double t = instants[k];
    const double u = 0.4 * (2.0 * std::sin(2.0 * t) - q) + 0.02 * (4.0 * std::cos(2.0 * t) - v);
    rows.push_back({t, u, kQuantum * std::round(q / kQuantum), t >= kStep ? kLoad : 0.0});
    if (k + 1 == instants.size()) break;
    const double next = instants[k + 1];
    if (t < kStep && next > kStep) {
      move(kStep - t, u);
      move(next - kStep, u - kLoad);
    } else {
      move(next - t, u - rows.back().d);
    }
  }
  return rows;
}

// Each time is shifted by at most `jitter` periods.
std::vector<double> instants(double jitter, testing::Random& random) {
  std::vector<double> times(static_cast<std::size_t>(std::lround(kDuration / kPeriod)) + 1);
  for (std::size_t k = 1; k < times.size(); ++k) {
    times[k] = (static_cast<double>(k) + random.uniform(-jitter, jitter)) * kPeriod;
  }
  return times;
}

// Loses bursts of 1 to 60 rows up to this share, at least half a second apart.
std::vector<Row> with_lost_rows(std::vector<Row> rows, double share, testing::Random& random) {
  auto left = std::lround(share * static_cast<double>(rows.size()));
  const long bursts = left / 60 + 1;
  const double apart = static_cast<double>(rows.size()) / static_cast<double>(bursts);
  for (long i = bursts - 1; i >= 0 && left > 0; --i) {
    const long length = i == 0 ? left : std::min(left, std::lround(random.uniform(1.0, 60.0)));
    left -= length;
    const auto first = rows.begin() + std::lround((static_cast<double>(i) + 0.5) * apart);
    rows.erase(first, first + length);
  }
  return rows;
}

class IrregularRecord : public ::testing::Test {
 protected:
  Recording estimate(const std::vector<Row>& rows, const std::string& observer,
                     std::vector<std::string> sets = {}) const {
    std::ofstream stream(file_);
    stream.precision(17);
    stream << "time_s,u,y\n";
    for (const Row& row : rows) stream << row.time_s << ',' << row.u << ',' << row.q << '\n';
    stream.close();
    Catalogue catalogue;
    for (const AxisEstimatorKind& kind : axis_estimators()) catalogue.add(kind);
    for (const AxisEstimatorKind& kind : published_estimators()) catalogue.add(kind);
    const ScenarioFile file(testing::source_file("data/estimate/estimate.toml"), "estimate");
    sets.insert(sets.begin(),
                {"csv.file=\"" + file_.string() + "\"", "plant.inertia=" + std::to_string(kInertia),
                 "plant.viscous_friction=" + std::to_string(kFriction),
                 "encoder.quantum=" + std::to_string(kQuantum)});
    const PreparedRun run = prepare_scenario(std::make_unique<RecordedEstimation>(catalogue), file,
                                             observer, sets, Tables::unchecked);
    return run.scenario->run({});
  }

  const testing::TemporaryPath file_{"irregular.csv"};
};

// Root mean square of d̂ − d, from half a second after the load step and from 0.2 s after each gap.
double error(const Recording& recording, const std::vector<Row>& rows) {
  const std::vector<double> d = recording.track("control").values("d_hat_Nm");
  double squares = 0.0;
  double count = 0.0;
  double gap_s = 0.0;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    if (rows[k].time_s - rows[k - 1].time_s > 1.5 * kPeriod) gap_s = rows[k].time_s;
    if (rows[k].time_s < kStep + 0.5 || rows[k].time_s < gap_s + 0.2) continue;
    squares += (d[k] - rows[k].d) * (d[k] - rows[k].d);
    count += 1.0;
  }
  return std::sqrt(squares / count);
}

double largest(const Recording& recording, double from_s) {
  const Track& track = recording.track("control");
  const std::vector<double> times = track.times();
  const std::vector<double> d = track.values("d_hat_Nm");
  double most = 0.0;
  for (std::size_t k = 0; k < d.size(); ++k) {
    if (times[k] >= from_s) most = std::max(most, std::abs(d[k]));
  }
  return most;
}

TEST_F(IrregularRecord, JitterAndLostRowsCostLittleBesideTheCleanRecord) {
  for (const char* observer : {"stf", "qvff", "qbank", "idob", "mdob"}) {
    testing::Random none;
    const std::vector<Row> clean = moved_motor(instants(0.0, none));
    const double of_clean = error(estimate(clean, observer), clean);
    for (int i = 0; i < 20; ++i) {
      testing::Random random(static_cast<unsigned>(100 + i));
      const double jitter = 0.1 * i / 19.0;
      const double lost = 0.05 * (7 * i % 20) / 19.0;
      const std::vector<Row> rows =
          with_lost_rows(moved_motor(instants(jitter, random)), lost, random);
      const double found = error(estimate(rows, observer), rows);
      EXPECT_LE(found, std::max(1.5 * of_clean, 0.01 * kLoad))
          << observer << ", jitter " << jitter << ", lost " << lost << ", clean " << of_clean;
    }
  }
}

TEST_F(IrregularRecord, TheDefaultFilterDoesNotEstimateALoadFromJitter) {
  testing::Random random(3);
  const std::vector<Row> rows = moved_motor(instants(0.04, random));
  const Recording recording = estimate(rows, "stf");
  EXPECT_LE(largest(recording, 0.1), 1.5 * kLoad);
  EXPECT_LE(error(recording, rows), 0.01 * kLoad);
  EXPECT_EQ(doubt_of(recording), std::nullopt);
}

TEST_F(IrregularRecord, OneLostRowDoesNotStartTheFilterAgain) {
  testing::Random none;
  std::vector<Row> rows = moved_motor(instants(0.0, none));
  rows.erase(rows.begin() + 5000);
  const Recording recording = estimate(rows, "stf");
  EXPECT_EQ(recording.metric("gap_count"), 1.0);
  EXPECT_LE(largest(recording, 1.2), 1.1 * kLoad);
  EXPECT_EQ(recording.track("control").values("stretch").back(), 1.0);
}

// The record has a constant period, but the samples were not taken so.
TEST_F(IrregularRecord, UncertainTimesActAsASensorErrorThatGrowsWithTheSpeed) {
  testing::Random random(5);
  std::vector<Row> rows = moved_motor(instants(0.2, random));
  for (std::size_t k = 0; k < rows.size(); ++k) {
    rows[k].time_s = static_cast<double>(k) * kPeriod;
  }
  const Recording believed = estimate(rows, "stf");
  const auto doubt = doubt_of(believed);
  ASSERT_TRUE(doubt.has_value());
  EXPECT_TRUE(doubt->starts_with("the model does not explain the data: ")) << *doubt;
  EXPECT_NE(doubt->find("csv.time_std_s"), std::string::npos) << *doubt;

  const double std_s = 0.2 * kPeriod / std::sqrt(3.0);
  const Recording known = estimate(rows, "stf", {"csv.time_std_s=" + std::to_string(std_s)});
  EXPECT_EQ(doubt_of(known), std::nullopt);
  EXPECT_LT(largest(known, 0.1), 0.3 * largest(believed, 0.1));
  EXPECT_LE(error(known, rows), 0.02 * kLoad);
}

TEST_F(IrregularRecord, WarnsOfAModelThatDoesNotExplainTheData) {
  testing::Random none;
  const std::vector<Row> rows = moved_motor(instants(0.0, none));
  for (const char* observer : {"stf", "qvff", "qbank", "idob"}) {
    EXPECT_EQ(doubt_of(estimate(rows, observer)), std::nullopt) << observer;
  }
  for (const char* wrong : {"csv.input_scale=-1", "csv.position_scale=57.3"}) {
    EXPECT_TRUE(doubt_of(estimate(rows, "idob", {wrong})).has_value()) << wrong;
  }
}

TEST_F(IrregularRecord, TheMultipleModelEstimatorNeedsNoTuning) {
  testing::Random random(7);
  const std::vector<Row> rows = moved_motor(instants(0.05, random));
  EXPECT_LE(error(estimate(rows, "qbank"), rows), 0.01 * kLoad);
}

class RecordedAxisFile : public ::testing::Test {
 protected:
  RecordedAxis read(const std::string& text, const RecordFormat& format = {}) const {
    std::ofstream(file_, std::ios::binary) << text;
    return read_recorded_axis(file_.string(), format);
  }

  // The error message without the file's name.
  std::string error_of(const std::string& text) const {
    try {
      read(text);
    } catch (const std::invalid_argument& error) {
      const std::string line = error.what();
      EXPECT_TRUE(line.starts_with(file_.string() + ":")) << line;
      return line.substr(file_.string().size() + 1);
    }
    return "";
  }

  const testing::TemporaryPath file_{"recorded.csv"};
};

TEST_F(RecordedAxisFile, ColumnsStandInAnyOrderBetweenOthersAndComments) {
  const RecordedAxis axis = read(
      "\xef\xbb\xbf# of a rig, saved by a spreadsheet\r\n"
      "y, note ,time_s,u\r\n\r\n"
      "1.5,a,0,-2\r\n+2.5,b, 1e-3 ,3e2\r\n");
  EXPECT_EQ(axis.times_s, (std::vector<double>{0.0, 1e-3}));
  EXPECT_EQ(axis.inputs, (std::vector<double>{-2.0, 300.0}));
  EXPECT_EQ(axis.positions, (std::vector<double>{1.5, 2.5}));
}

TEST_F(RecordedAxisFile, SeparatorsAndDecimalCommasAreFound) {
  for (const char* text : {"time_s;u;y\n0;-2;1,5\n0,001;3e2;+2,5\n",
                           "\"time_s\"\t\"u\"\ty\n0\t-2\t1.5\n1e-3\t300\t2.5\n",
                           "time_s   u y\n 0  -2 1,5\n0.001\t300  2,5 \n",
                           "time_s,u,\"y\",\"a, b\"\n0,-2,1.5,x\n0.001,\"300\",2.5,\"x, y\"\n",
                           "empty;time_s;u;y;\n;0;-2;1,5;\n;0,001;300;2,5;\n"}) {
    const RecordedAxis axis = read(text);
    EXPECT_EQ(axis.times_s, (std::vector<double>{0.0, 1e-3})) << text;
    EXPECT_EQ(axis.inputs, (std::vector<double>{-2.0, 300.0})) << text;
    EXPECT_EQ(axis.positions, (std::vector<double>{1.5, 2.5})) << text;
  }
}

TEST_F(RecordedAxisFile, ColumnsHaveOtherNamesAndUnits) {
  const RecordFormat format{"t [ms]", "current", "counts", 1e-3, 0.5, -2.0};
  const RecordedAxis axis = read("current;counts;t [ms]\n4;1;10\n6;2;11\n", format);
  EXPECT_EQ(axis.times_s, (std::vector<double>{0.01, 0.011}));
  EXPECT_EQ(axis.inputs, (std::vector<double>{2.0, 3.0}));
  EXPECT_EQ(axis.positions, (std::vector<double>{-2.0, -4.0}));
}

TEST_F(RecordedAxisFile, MessagesNameTheLine) {
  const std::string head = "time_s,u,y\n";
  EXPECT_EQ(error_of(""), " is empty");
  EXPECT_EQ(error_of("time,u,y\n"),
            "1: there is no column time_s (did you mean time?): the first line has time, u, y; "
            "set csv.time_column to its name");
  EXPECT_EQ(error_of("time_s,u,y,u\n"), "1: there are two columns u");
  EXPECT_EQ(error_of(head + "0,1,2\n"), " has fewer than two rows with different times");
  EXPECT_EQ(error_of(head + "0,1,2\n1,2\n2,1,2\n"), "3: has 2 values, the first line 3");
  EXPECT_EQ(error_of(head + "0,1,2\n1,0x10,1\n"), "3: u: must be a finite number, is \"0x10\"");
  EXPECT_EQ(error_of(head + "0,1,2\n1,1e999,1\n"), "3: u: must be a finite number, is \"1e999\"");
  EXPECT_EQ(error_of("time_s;u;y\n0;1;2\n1;1.000,5;2\n"),
            "3: u: must be a finite number, is \"1.000,5\"");
  EXPECT_EQ(error_of(head + "0,5,1,2\n"),
            "2: has 4 values, the first line 3 (decimal commas need another separator)");
  EXPECT_THROW(read_recorded_axis("/nowhere/record.csv"), std::invalid_argument);
}

TEST(RecordedTiming, ThePeriodIgnoresGapsAndAWarningNamesTheirRows) {
  const RecordedTiming timing = timing_of({0.0, 1.0, 2.0, 7.0, 8.0, 9.0, 12.0}, 0.0, 1.5, 0.1);
  EXPECT_EQ(timing.period_s, 1.0);
  EXPECT_EQ(timing.gaps, (std::vector<std::size_t>{3, 6}));
  EXPECT_EQ(timing.jitter_max_s, 0.0);
  EXPECT_EQ(timing.irregular, 0U);
}

TEST(RecordedTiming, JitterIsCountedAndAveragedOut) {
  const RecordedTiming timing = timing_of({0.0, 1.2, 2.0, 3.0, 4.0}, 0.0, 1.5, 0.1);
  EXPECT_DOUBLE_EQ(timing.period_s, 1.0);
  EXPECT_EQ(timing.irregular, 2U);
  EXPECT_NEAR(timing.jitter_max_s, 0.2, 1e-12);
  EXPECT_NEAR(timing.jitter_rms_s, std::sqrt((0.04 + 0.04) / 4.0), 1e-12);
  EXPECT_EQ(timing_of({0.0, 1.2, 2.0, 3.0, 4.0}, 0.8, 1.6, 0.5).period_s, 0.8);
  // Decimal stamps are rounded in their last digit, which is no jitter.
  std::vector<double> decimal;
  for (int k = 0; k < 5000; ++k) decimal.push_back(k / 1000.0);
  EXPECT_EQ(timing_of(decimal, 0.0, 1.5, 0.1).jitter_rms_s, 0.0);
  EXPECT_EQ(timing_of({0.0, 1.0, 2.0}, 0.5, 1.5, 0.1).gaps.size(), 2U);
}

}  // namespace breakwater::irregular_record_test
