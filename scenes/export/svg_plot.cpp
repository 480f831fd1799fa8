#include "scenes/export/svg_plot.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <pugixml.hpp>
#include <sstream>

#include "scenes/support/format.h"
#include "scenes/support/printable.h"

namespace taut {
namespace {

using pugi::xml_node;

constexpr double kWidth = 760, kPanelHeight = 190, kLeft = 84, kRight = 130, kTop = 40, kGapBelow = 46;
constexpr const char* kColors[] = {"#2f6db5", "#d9772b", "#3a8f5c", "#a5478f", "#8a6d3b"};

struct Line {
  std::string name;
  std::vector<double> values;
};

struct Panel {
  std::string title;
  std::vector<Line> lines;
  bool logarithmic = false;
};

xml_node element(xml_node parent, const char* name,
                 std::initializer_list<std::pair<const char*, std::string>> attributes,
                 const std::string& text = {}) {
  xml_node node = parent.append_child(name);
  for (const auto& [key, value] : attributes) node.append_attribute(key).set_value(value.c_str());
  if (!text.empty()) node.text().set(printable(text).c_str());
  return node;
}

std::string px(double value) { return format("%.2f", value); }

std::string in_brackets(const std::string& unit) { return unit.empty() ? "" : " [" + unit + "]"; }

/// What belongs together in one panel: a probe's columns have its name before the dot.
std::vector<Panel> panels(RecordingReader& recording) {
  const auto& scalars = recording.header().scalars;
  std::vector<Line> lines(scalars.size());
  for (int f = 0; f < recording.frame_count(); ++f)
    for (std::size_t s = 0; s < scalars.size(); ++s) lines[s].values.push_back(recording.frame(f).scalars[s]);

  using Group = RecordedScalar::Group;
  Panel energy{"Energy [J]", {}}, gap{"Largest joint gap [m, rad]", {}, true};
  std::vector<Panel> probes;
  std::string last_stem;
  for (std::size_t s = 0; s < scalars.size(); ++s) {
    const std::string& name = scalars[s].name;
    lines[s].name = name;
    if (scalars[s].group == Group::kEnergy) energy.lines.push_back(lines[s]);
    if (scalars[s].group == Group::kGap) gap.lines.push_back(lines[s]);
    if (scalars[s].group != Group::kProbe) continue;
    const std::string stem = name.substr(0, name.rfind('.'));
    if (stem != last_stem) probes.push_back({stem, {}});
    last_stem = stem;
    lines[s].name = name.substr(name.rfind('.') + 1) + in_brackets(scalars[s].unit);
    probes.back().lines.push_back(lines[s]);
  }
  if (energy.lines.size() == 2) {
    Line total{"total", energy.lines[0].values};
    for (std::size_t f = 0; f < total.values.size(); ++f) total.values[f] += energy.lines[1].values[f];
    energy.lines.push_back(total);
    for (Line& line : energy.lines) line.name = line.name.substr(0, line.name.find(' '));
  }
  std::vector<Panel> all{energy, gap};
  all.insert(all.end(), probes.begin(), probes.end());
  return all;
}

/// Maps values of a panel to pixels.
class Scale {
 public:
  explicit Scale(const Panel& panel) : logarithmic_(panel.logarithmic) {
    for (const Line& line : panel.lines)
      for (const double value : line.values)
        if (const double v = map(value); std::isfinite(v))
          low_ = std::min(low_, v), high_ = std::max(high_, v);
    if (low_ > high_) low_ = 0, high_ = 1;
    if (logarithmic_) low_ = std::floor(low_), high_ = std::max(std::ceil(high_), low_ + 1);
    const double margin = logarithmic_ ? 0 : std::max(0.05 * (high_ - low_), 1e-9 * std::abs(high_) + 1e-300);
    low_ -= margin, high_ += margin;
  }
  /// From 0 at the bottom to 1 at the top; not finite where a logarithm has no value.
  double part(double value) const { return (map(value) - low_) / (high_ - low_); }
  std::vector<double> ticks() const {
    std::vector<double> at = axis_ticks(low_, high_, 5);
    if (!logarithmic_) return at;
    std::erase_if(at, [](double power) { return power != std::round(power); });
    for (double& power : at) power = std::pow(10, power);
    return at;
  }

 private:
  double map(double value) const {
    return logarithmic_ ? (value > 0 ? std::log10(value) : std::nan("")) : value;
  }
  bool logarithmic_;
  double low_ = std::numeric_limits<double>::infinity(), high_ = -low_;
};

void draw_panel(xml_node svg, const Panel& panel, double top, RecordingReader& recording) {
  const double first = recording.time(0), last = recording.time(recording.frame_count() - 1);
  const double span = last > first ? last - first : 1;
  const double right = kWidth - kRight, bottom = top + kPanelHeight - kGapBelow;
  const auto x = [&](double time) { return kLeft + (time - first) / span * (right - kLeft); };
  const Scale scale(panel);
  const auto y = [&](double value) { return bottom - scale.part(value) * (bottom - top); };

  element(svg, "text", {{"x", px(kLeft)}, {"y", px(top - 8)}, {"class", "title"}}, panel.title);
  for (const double tick : scale.ticks()) {
    element(svg, "path", {{"class", "grid"}, {"d", format("M%.2f %.2fH%.2f", kLeft, y(tick), right)}});
    element(svg, "text", {{"x", px(kLeft - 6)}, {"y", px(y(tick) + 4)}, {"class", "y"}}, format("%g", tick));
  }
  for (const double tick : axis_ticks(first, first + span, 8)) {
    element(svg, "path", {{"class", "grid"}, {"d", format("M%.2f %.2fV%.2f", x(tick), top, bottom)}});
    element(svg, "text", {{"x", px(x(tick))}, {"y", px(bottom + 16)}, {"class", "x"}}, format("%g s", tick));
  }
  int number = 0;
  for (const Line& line : panel.lines) {
    const std::string color = kColors[number % 5];
    std::string path;
    bool pen_down = false;
    for (std::size_t f = 0; f < line.values.size(); ++f) {
      const double height = y(line.values[f]);
      if (std::isfinite(height))
        path += format("%c%.2f %.2f", pen_down ? 'L' : 'M', x(recording.time(static_cast<int>(f))), height);
      pen_down = std::isfinite(height);
    }
    if (!path.empty()) element(svg, "path", {{"class", "line"}, {"stroke", color}, {"d", path}});
    element(svg, "text",
            {{"x", px(right + 10)}, {"y", px(top + 12 + 18 * number)}, {"fill", color}, {"class", "name"}},
            line.name);
    ++number;
  }
}

}  // namespace

std::vector<double> axis_ticks(double low, double high, int count) {
  const double raw = (high - low) / count, power = std::pow(10, std::floor(std::log10(raw)));
  const double step = power * (raw / power > 5 ? 10 : raw / power > 2 ? 5 : raw / power > 1 ? 2 : 1);
  std::vector<double> ticks;
  for (double k = std::ceil(low / step); k * step <= high * (1 + 1e-12) && ticks.size() < 100; ++k)
    ticks.push_back(k * step);
  return ticks;
}

std::string svg_plot(RecordingReader& recording) {
  const std::vector<Panel> all = panels(recording);
  const double height = kTop + kPanelHeight * static_cast<double>(all.size()) + 20;
  pugi::xml_document document;
  xml_node svg = element(document, "svg",
                         {{"xmlns", "http://www.w3.org/2000/svg"},
                          {"viewBox", format("0 0 %.2f %.2f", kWidth, height)},
                          {"width", px(kWidth)},
                          {"height", px(height)}});
  element(svg, "title", {}, recording.header().scene);
  element(svg, "style", {},
          "svg{background:#fff;font:12px system-ui,sans-serif;color:#222}.grid{stroke:#0002}"
          ".line{fill:none;stroke-width:1.6;stroke-linejoin:round}text:not(.name){fill:#333}.title{font-"
          "weight:600}"
          ".y{text-anchor:end}.x{text-anchor:middle}.head{font-size:15px;font-weight:600}");
  element(svg, "rect", {{"width", "100%"}, {"height", "100%"}, {"fill", "#fff"}});
  element(svg, "text", {{"x", px(kLeft)}, {"y", "22"}, {"class", "head"}}, recording.header().scene);
  double top = kTop + 24;
  for (const Panel& panel : all) {
    draw_panel(svg, panel, top, recording);
    top += kPanelHeight;
  }
  std::ostringstream out;
  document.save(out, " ", pugi::format_default | pugi::format_no_declaration);
  return out.str();
}

}  // namespace taut
