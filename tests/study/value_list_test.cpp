#include <breakwater/study/value_list.h>

#include <cmath>
#include <stdexcept>

#include <breakwater/study/study.h>
#include "support.h"

namespace breakwater::value_list_test {
namespace {

using Values = std::vector<double>;

TEST(ValueList, HasTheNumbersOfTwelveDigits) {
  EXPECT_EQ(value_list("lin(0.06,0.12,4)"), (Values{0.06, 0.08, 0.1, 0.12}));
  EXPECT_EQ(value_list(" lin( -1 , 1, 5 ) "), (Values{-1.0, -0.5, 0.0, 0.5, 1.0}));
  EXPECT_EQ(value_list("lin(0,1,11)"),
            (Values{0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0}));
  EXPECT_EQ(value_list("log(1e-3,1e3,7)"), (Values{1e-3, 1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3}));
  EXPECT_EQ(value_list("log(500,8000,5)"), (Values{500, 1000, 2000, 4000, 8000}));
  EXPECT_EQ(value_list("lin(0.1,0.3,2)"), (Values{0.1, 0.3}));
}

TEST(ValueList, KeepsAllDigitsOfOtherNumbers) {
  EXPECT_EQ(value_list("lin(0,1,4)"), (Values{0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0}));
  const Values values = value_list("log(1,2,13)");  // semitones
  for (int i = 0; i <= 12; ++i) {
    EXPECT_NEAR(values[i], std::exp2(i / 12.0), 4e-16 * values[i]) << i;
  }
}

TEST(ValueList, EndsAreExactAndValuesGoUp) {
  for (const std::string rule : {"lin(0.1,0.7,1000)", "log(0.1,0.7,1000)", "lin(-3.3,1e9,77)"}) {
    const Values values = value_list(rule);
    EXPECT_EQ(values.front(), rule[4] == '-' ? -3.3 : 0.1);
    EXPECT_EQ(values.back(), rule[4] == '-' ? 1e9 : 0.7);
    for (std::size_t i = 1; i < values.size(); ++i) EXPECT_LT(values[i - 1], values[i]) << rule;
  }
}

std::string reason(const std::string& text) {
  return complaint_of([&] { value_list(text); });
}

TEST(ValueList, RefusesInvalidArguments) {
  EXPECT_EQ(reason("lin(1,0,3)"), "\"lin(1,0,3)\" must rise: 1 is above 0");
  EXPECT_EQ(reason("lin(1,1,3)"), "\"lin(1,1,3)\" is empty: both ends are the same");
  EXPECT_EQ(reason("log(0,1,3)"), "\"log(0,1,3)\" must be positive: it is logarithmic");
  EXPECT_EQ(reason("log(-1,1,3)"), "\"log(-1,1,3)\" must be positive: it is logarithmic");
  EXPECT_EQ(reason("lin(-1e308,1e308,3)"), "\"lin(-1e308,1e308,3)\" is too wide");
  for (const std::string text :
       {"lin(0,1,1)", "lin(0,1,0)", "lin(0,1,-4)", "lin(0,1,2.5)", "lin(0,1,1e12)"}) {
    EXPECT_EQ(reason(text), '"' + text + "\" must be an integer number of values, 2 to 10000000");
  }
  for (const std::string text : {"lin(a,1,3)", "lin(0,inf,3)", "lin(nan,1,3)", "lin(0,1e999,3)",
                                 "lin(0,1,three)", "lin(0x1,2,3)"}) {
    EXPECT_EQ(reason(text), '"' + text + "\" has something else than three finite numbers");
  }
  for (const std::string text : {"", "lin", "lin(0,1)", "lin(0,1,3,4)", "lin(0,1,3", "lin(0 1 3)",
                                 "cub(0,1,3)", "lin(0,1,3)x", "log((0,1,3))"}) {
    EXPECT_EQ(reason(text),
              '"' + text + "\" is neither lin(a,b,n) nor log(a,b,n), n values from a to b");
  }
}

TEST(ValueList, IsDistinguishedFromOtherTexts) {
  EXPECT_TRUE(is_value_list("lin(0,1,3)"));
  EXPECT_TRUE(is_value_list("  log (0,"));
  EXPECT_FALSE(is_value_list("linear"));
  EXPECT_FALSE(is_value_list("hpfc"));
}

TEST(OptionParts, AnEscapedQuoteDoesNotEndAText) {
  using Parts = std::vector<std::string>;
  EXPECT_EQ(option_parts(R"("a\",b", c)"), (Parts{R"("a\",b")", "c"}));
  EXPECT_EQ(option_parts(R"("a\\",b)"), (Parts{R"("a\\")", "b"}));
  EXPECT_EQ(option_parts(R"('a\',b)"), (Parts{R"('a\')", "b"})) << "there it is a character";
}

}  // namespace
}  // namespace breakwater::value_list_test
