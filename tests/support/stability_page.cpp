#include <cmath>
#include <cstdio>

#include "support/stability.h"

namespace ngs::test {
namespace {

constexpr int kColumns = 4, kPanelWidth = 270, kPanelHeight = 170, kLeft = 38, kTop = 34, kPlotWidth = 216,
              kPlotHeight = 96;
constexpr double kLowest = -2, kHighest = 9;  // log10 of the ratio

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '&')
      out += "&amp;";
    else
      out += c;
  }
  return out;
}

std::string number(double x) {
  char text[32];
  if (std::isnan(x)) return "NaN";
  if (std::isinf(x)) return x < 0 ? "-inf" : "inf";
  std::snprintf(text, sizeof text, "%.3g", x);
  return text;
}
std::string ratio_text(double r) { return std::isfinite(r) ? number(r) : "wrong"; }

double x_of(std::size_t i, std::size_t n) { return kLeft + (n == 1 ? 0.5 : double(i) / double(n - 1)) * kPlotWidth; }
double y_of(double ratio) {
  const double at = ratio > 0 ? std::clamp(std::log10(std::min(ratio, 1e30)), kLowest, kHighest) : kLowest;
  return kTop + (kHighest - at) / (kHighest - kLowest) * kPlotHeight;
}

std::string line(const HardResult& r, double (Worst::*of)() const, const char* style) {
  std::string points, dots;
  for (std::size_t i = 0; i < r.sweep.size(); ++i) {
    const std::string x = number(x_of(i, r.sweep.size())), y = number(y_of((r.sweep[i].*of)()));
    points += x + "," + y + " ";
    dots += "<circle cx=\"" + x + "\" cy=\"" + y + "\" r=\"2.4\" class=\"" + style + "\"/>";
  }
  return "<polyline points=\"" + points + "\" class=\"" + style + "\"/>" + dots;
}

/// `text` in lines of about 46 characters, at most two.
std::string title_lines(const std::string& text) {
  std::size_t cut = text.size() > 46 ? text.rfind(' ', 46) : std::string::npos;
  if (cut == std::string::npos) cut = text.size();
  std::string out = "<text x=\"4\" y=\"12\" class=\"name\">" + escaped(text.substr(0, cut)) + "</text>";
  if (cut < text.size()) out += "<text x=\"4\" y=\"24\" class=\"name\">" + escaped(text.substr(cut + 1)) + "</text>";
  return out;
}

std::string panel(const HardResult& r) {
  std::string svg = "<title>" + escaped(r.name) + "</title>" + title_lines(r.name);
  for (const int decade : {0, 4, 8}) {
    const std::string y = number(y_of(std::pow(10.0, decade)));
    svg += "<line x1=\"38\" x2=\"254\" y1=\"" + y + "\" y2=\"" + y + "\" class=\"grid\"/><text x=\"34\" y=\"" + y +
           "\" class=\"tick end\">1e" + std::to_string(decade) + "</text>";
  }
  const std::string budget = number(y_of(r.hard.budget));
  svg += "<line x1=\"38\" x2=\"254\" y1=\"" + budget + "\" y2=\"" + budget + "\" class=\"budget\"/>";
  if (r.has_naive()) svg += line(r, &Worst::naive, "naive");
  svg += line(r, &Worst::ours, "ours");
  for (const std::size_t i : {std::size_t(0), r.sweep.size() - 1})
    if (i == 0 || r.sweep.size() > 1)
      svg += "<text x=\"" + number(x_of(i, r.sweep.size())) + "\" y=\"143\" class=\"tick middle\">" +
             number(r.hard.values[i]) + "</text>";
  return svg + "<text x=\"146\" y=\"157\" class=\"tick middle\">" + escaped(r.hard.axis) + "</text>";
}

std::string kernel_section(const std::string& kernel, const std::vector<const HardResult*>& cases) {
  const int rows = (int(cases.size()) + kColumns - 1) / kColumns;
  std::string html = "<h2>" + escaped(kernel) + "</h2>\n<svg viewBox=\"0 0 " + std::to_string(kColumns * kPanelWidth) +
                     " " + std::to_string(rows * kPanelHeight) +
                     "\" role=\"img\" aria-label=\"ratio against hardness, " + escaped(kernel) + "\">\n";
  for (std::size_t i = 0; i < cases.size(); ++i)
    html += "<g transform=\"translate(" + std::to_string(int(i) % kColumns * kPanelWidth) + " " +
            std::to_string(int(i) / kColumns * kPanelHeight) + ")\">" + panel(*cases[i]) + "</g>\n";
  html +=
      "</svg>\n<div "
      "class=\"wide\"><table><tr><th>case</th><th>hardness</th><th>worst</th><th>budget</th><th>textbook "
      "form</th><th>its worst</th><th>values</th></tr>\n";
  for (const HardResult* r : cases)
    html += std::string("<tr") + (r->passed() ? "" : " class=\"failed\"") + "><td>" + escaped(r->name) + "</td><td>" +
            escaped(r->hard.axis) + " to " + number(r->hard.values.back()) + "</td><td class=\"n\">" +
            ratio_text(r->worst()) + "</td><td class=\"n\">" + number(r->hard.budget) + "</td><td>" +
            escaped(r->hard.naive.form) + "</td><td class=\"n\">" +
            (r->has_naive() ? ratio_text(r->naive_worst()) : "") + "</td><td class=\"n\">" +
            std::to_string(r->values()) + "</td></tr>\n";
  return html + "</table></div>\n";
}

constexpr const char* kHead = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>ngs: numerical stability</title>
<style>
:root { color-scheme: light dark; --ink: #1c2733; --paper: #fcfcfb; --faint: #d9dde1; --ours: #0b6fb8; --naive: #c4541a; }
@media (prefers-color-scheme: dark) { :root { --ink: #dfe5ea; --paper: #15191d; --faint: #343c44; --ours: #5db3f0; --naive: #f0955d; } }
body { font: 15px/1.45 system-ui, sans-serif; color: var(--ink); background: var(--paper); max-width: 1100px; margin: 2em auto; padding: 0 1em; }
svg { width: 100%; height: auto; } text { fill: var(--ink); font-size: 10.5px; } .tick { font-size: 9px; opacity: .75; dominant-baseline: middle; }
.end { text-anchor: end; } .middle { text-anchor: middle; } .grid { stroke: var(--faint); } polyline { fill: none; stroke-width: 1.6; }
polyline.ours { stroke: var(--ours); } circle.ours { fill: var(--ours); } polyline.naive { stroke: var(--naive); stroke-dasharray: 4 3; }
circle.naive { fill: var(--naive); } .budget { stroke: var(--ink); stroke-dasharray: 1 3; stroke-width: 1.4; }
.wide { overflow-x: auto; } table { border-collapse: collapse; font-size: 13px; } th, td { text-align: left; padding: .15em .9em .15em 0; border-bottom: 1px solid var(--faint); vertical-align: top; }
.n { text-align: right; font-variant-numeric: tabular-nums; } .failed td { color: #d02020; font-weight: 600; } b.ours { color: var(--ours); } b.naive { color: var(--naive); }
</style></head><body>
<h1>Numerical stability</h1>
<p>Each case grows harder from left to right. The ratio is the worst error over random inputs in units of the error that rounding to float
alone explains, eps · condition · |value|: near 1 is as good as the arithmetic allows. <b class="ours">Solid: ngs.</b>
<b class="naive">Dashed: the textbook form in float.</b> Dotted: the budget pinned in the test. NaN, Inf and wrong answers for degenerate
inputs are drawn at the top, exact answers at the bottom; a budget of 0 requires exact answers.</p>
)";

}  // namespace

std::string stability_page(const std::vector<HardResult>& results) {
  std::string html = kHead;
  std::int64_t values = 0, failed = 0;
  std::vector<std::string> kernels;
  for (const HardResult& r : results) {
    values += r.values(), failed += !r.passed();
    if (std::find(kernels.begin(), kernels.end(), r.kernel) == kernels.end()) kernels.push_back(r.kernel);
  }
  html += "<p>" + std::to_string(results.size()) + " cases, " + std::to_string(failed) + " failed, " +
          std::to_string(values) + " values compared.</p>\n";
  for (const std::string& kernel : kernels) {
    std::vector<const HardResult*> cases;
    for (const HardResult& r : results)
      if (r.kernel == kernel) cases.push_back(&r);
    html += kernel_section(kernel, cases);
  }
  return html + "</body></html>\n";
}

}  // namespace ngs::test
