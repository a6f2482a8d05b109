// Tables of an axis. tests/python/estimate_test.py has records with irregular times.
#include <breakwater/recorded/recorded_axis.h>
#include "support.h"

namespace breakwater::recorded_axis_test {

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

}  // namespace breakwater::recorded_axis_test
