#include <breakwater/pages/latex.h>

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include <breakwater/pages/labels.h>

namespace breakwater {

std::string latex_escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '\\':
        escaped += "\\textbackslash{}";
        break;
      case '~':
        escaped += "\\textasciitilde{}";
        break;
      case '^':
        escaped += "\\textasciicircum{}";
        break;
      case '&':
      case '%':
      case '$':
      case '#':
      case '_':
      case '{':
      case '}':
        escaped += '\\';
        escaped += c;
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string latex_number(double value) {
  const std::string text = fmt::format("{:.4g}", value);
  const std::size_t e = text.find('e');
  if (e == std::string::npos) return text[0] == '-' ? "$" + text + "$" : text;
  return fmt::format("${} \\times 10^{{{}}}$", text.substr(0, e),
                     std::atoi(text.c_str() + e + 1));  // NOLINT(cert-err34-c): our own digits
}

std::string latex_name(const std::string& metric, const std::string& unit) {
  std::string text = latex_escaped(metric_label(metric, unit));
  if (unit.empty() || unit == "1") return text;
  std::string plain = latex_escaped(unit);
  for (const auto& [sign, code] : {std::pair("²", "$^2$"), std::pair("³", "$^3$")}) {
    for (std::size_t at = plain.find(sign); at != std::string::npos; at = plain.find(sign)) {
      plain.replace(at, std::string(sign).size(), code);
    }
  }
  return fmt::format("{} [{}]", text, plain);
}

std::string latex_table(const std::vector<std::vector<std::string>>& rows) {
  std::string text = "% needs \\usepackage{booktabs}\n\\begin{tabular}{l" +
                     std::string(rows.front().size() - 1, 'r') + "}\n\\toprule\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    text += fmt::format("{} \\\\\n", fmt::join(rows[i], " & "));
    if (i == 0) text += "\\midrule\n";
  }
  return text + "\\bottomrule\n\\end{tabular}\n";
}

}  // namespace breakwater
