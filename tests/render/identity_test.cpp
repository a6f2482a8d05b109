// The colours of lines: readers of any sight tell them apart, on paper and on the dark page.
#include <breakwater/render/identity.h>

#include <gtest/gtest.h>
#include <support.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <set>
#include <string>

namespace breakwater::identity_test {
namespace {

using Triple = std::array<double, 3>;
using Matrix = std::array<Triple, 3>;

constexpr Matrix kNormal = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
// Linear RGB as dichromats see it: G. M. Machado, M. M. Oliveira, L. A. F. Fernandes, "A
// Physiologically-based Model for Simulation of Color Vision Deficiency", 2009, severity 1.
constexpr Matrix kProtanopia = {{{0.152286, 1.052583, -0.204868},
                                 {0.114503, 0.786281, 0.099216},
                                 {-0.003882, -0.048116, 1.051998}}};
constexpr Matrix kDeuteranopia = {{{0.367322, 0.860646, -0.227968},
                                   {0.280085, 0.672501, 0.047413},
                                   {-0.011820, 0.042940, 0.968881}}};
constexpr Matrix kTritanopia = {{{1.255528, -0.076749, -0.178779},
                                 {-0.078411, 0.930809, 0.147602},
                                 {0.004733, 0.691367, 0.303900}}};
constexpr Matrix kXyz = {{{0.4124564, 0.3575761, 0.1804375},
                          {0.2126729, 0.7151522, 0.0721750},
                          {0.0193339, 0.1191920, 0.9503041}}};

Triple times(const Matrix& matrix, const Triple& v) {
  Triple product{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) product[i] += matrix[i][k] * v[k];
  }
  return product;
}

Triple linear(const std::string& hex) {
  Triple rgb{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double c = std::stoi(hex.substr(1 + 2 * k, 2), nullptr, 16) / 255.0;
    rgb[k] = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  }
  return rgb;
}

Triple lab(const Triple& rgb, const Matrix& sight) {
  constexpr Triple kWhite = {0.95047, 1.0, 1.08883};
  Triple seen = times(sight, rgb);
  for (double& c : seen) c = std::clamp(c, 0.0, 1.0);
  Triple f = times(kXyz, seen);
  for (std::size_t k = 0; k < 3; ++k) {
    f[k] /= kWhite[k];
    f[k] = f[k] > 216.0 / 24389.0 ? std::cbrt(f[k]) : (24389.0 / 27.0 * f[k] + 16.0) / 116.0;
  }
  return {116.0 * f[1] - 16.0, 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2])};
}

double contrast(const std::string& one, const std::string& other) {
  const double a = times(kXyz, linear(one))[1] + 0.05, b = times(kXyz, linear(other))[1] + 0.05;
  return std::max(a, b) / std::min(a, b);
}

TEST(Identity, AllColoursDifferForEverySightAndStandOutFromThePage) {
  for (const auto& [colour_of, paper] : {std::pair(&light_colour, std::string("#ffffff")),
                                         std::pair(&dark_colour, std::string("#14181c"))}) {
    for (Identity i = kReferenceIdentity; i < kIdentityColours; ++i) {
      EXPECT_GE(contrast(colour_of(i), paper), 3.0) << colour_of(i);  // WCAG 1.4.11
      for (Identity k = kReferenceIdentity; k < i; ++k) {
        for (const Matrix& sight : {kNormal, kProtanopia, kDeuteranopia, kTritanopia}) {
          const Triple a = lab(linear(colour_of(i)), sight), b = lab(linear(colour_of(k)), sight);
          EXPECT_GE(std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]), 20.0)
              << colour_of(i) << " and " << colour_of(k);
        }
      }
    }
  }
}

TEST(Identity, EachColourHasADashAndTheyComeAgainWithOthers) {
  std::set<std::pair<std::string, int>> pairs;
  constexpr int kAll = kIdentityColours * kIdentityDashes;
  for (Identity i = 0; i < kAll; ++i) pairs.emplace(light_colour(i), dash_number(i));
  EXPECT_EQ(pairs.size(), kAll);
}

TEST(Identity, ASignalsRoleHasItsColourAndNoTwoLinesHaveTheSame) {
  EXPECT_EQ(role_of_signal("force_true_N"), role_of_signal("physics/force_true_N"));
  EXPECT_EQ(role_of_signal("force.reference_N"), kReferenceIdentity);
  EXPECT_EQ(role_of_signal("error_m[3]"), std::nullopt);
  EXPECT_EQ(distinct_identities({1, std::nullopt, 1, kReferenceIdentity, kReferenceIdentity}),
            (std::vector<Identity>{1, 0, 2, kReferenceIdentity, kReferenceIdentity}));
  EXPECT_EQ(candidate_identities({"b", "mine"}, {"a", "b"}), (std::vector<Identity>{1, 0}));
}

TEST(Identity, TheScriptOfFiguresHasTheSame) {
  std::ifstream file(testing::source_file("scripts/figures.py"));
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  std::string colours;
  for (Identity i = 0; i < kIdentityColours; ++i) {
    colours += "\"" + std::string(light_colour(i)) + "\", ";
  }
  colours += "\"" + std::string(light_colour(kReferenceIdentity)) + "\"";
  EXPECT_NE(text.find("COLOURS = [" + colours + "]"), std::string::npos) << colours;
}

}  // namespace
}  // namespace breakwater::identity_test
