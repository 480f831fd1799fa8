#include "scenes/import/xml_files.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <utility>

#include "scenes/files/scene_file.h"
#include "scenes/support/suggestion.h"

namespace taut::model {
namespace {

/// Names of what a model looks like, by themselves or with the element in front.
const std::set<std::string_view> kLooks = {
    "rgba",  "material", "texture",  "light",     "camera",    "visual",      "statistic",
    "skin",  "ambient",  "color",    "diffuse",   "emissive",  "specular",    "headlight",
    "group", "width",    "texcoord", "site size", "site type", "site fromto", "compiler texturedir"};

/// How another program computes.
const std::set<std::string_view> kComputes = {"option integrator",
                                              "option solver",
                                              "option iterations",
                                              "option tolerance",
                                              "option ls_iterations",
                                              "option ls_tolerance",
                                              "option noslip_iterations",
                                              "option noslip_tolerance",
                                              "option ccd_iterations",
                                              "option ccd_tolerance",
                                              "option mpr_iterations",
                                              "option mpr_tolerance",
                                              "option jacobian",
                                              "option cone",
                                              "option impratio",
                                              "option sleep_tolerance",
                                              "flag warmstart",
                                              "flag energy",
                                              "flag multiccd",
                                              "flag nativeccd",
                                              "flag island",
                                              "flag sleep",
                                              "flag midphase",
                                              "flag fwdinv",
                                              "body sleep",
                                              "size"};

/// Softness that goes with the mass it acts on, which no stiffness is.
const std::set<std::string_view> kSoft = {"solref",         "solimp",         "solreflimit", "solimplimit",
                                          "solreffriction", "solimpfriction", "solrefsolve"};

/// What becomes of an element, or of an attribute of it, that nobody has asked for.
const char* fate_of(std::string_view element, std::string_view attribute) {
  const std::string both = std::string(element) + ' ' + std::string(attribute);
  const auto is_in = [&](const std::set<std::string_view>& names) {
    return names.contains(both) || names.contains(attribute.empty() ? element : attribute);
  };
  if (is_in(kLooks)) return ": only looks, left out";
  if (is_in(kComputes)) return ": how another program computes, left out";
  if (is_in(kSoft)) return ": softness that goes with the mass has no counterpart, it is rigid";
  if (element == "transmission") return ": of controllers, left out";
  return ": has no counterpart";
}

/// Places at which lines begin.
std::vector<std::ptrdiff_t> line_starts(std::string_view text) {
  std::vector<std::ptrdiff_t> starts{0};
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] == '\n') starts.push_back(static_cast<std::ptrdiff_t>(i) + 1);
  return starts;
}

int line_at(const std::vector<std::ptrdiff_t>& starts, std::ptrdiff_t offset) {
  return static_cast<int>(std::upper_bound(starts.begin(), starts.end(), offset) - starts.begin());
}

/// The line of the first element that is nested too deep; 0: none.
pugi::xml_node too_deep(const pugi::xml_node& root) {
  int depth = 0;
  for (pugi::xml_node node = root; node;) {
    if (depth > kMostElementsDeep) return node;
    if (node.first_child()) {
      node = node.first_child();
      ++depth;
      continue;
    }
    while (node && node != root && !node.next_sibling()) {
      node = node.parent();
      --depth;
    }
    if (!node || node == root) break;
    node = node.next_sibling();
  }
  return {};
}

}  // namespace

struct XmlFiles::File {
  std::filesystem::path path, folder;
  std::vector<std::ptrdiff_t> lines;
  pugi::xml_document document;
};

XmlFiles::XmlFiles() = default;
XmlFiles::~XmlFiles() = default;

pugi::xml_node XmlFiles::open(const std::filesystem::path& path) {
  try {
    return parse(read_text_file(path), path);
  } catch (const SceneFileError& error) {
    throw ImportError({path.string(), 0}, error.problems().front().message);
  }
}

pugi::xml_node XmlFiles::parse(std::string_view text, const std::filesystem::path& path) {
  return parse_as_part(text, path, path.parent_path());
}

pugi::xml_node XmlFiles::open_model(const pugi::xml_node& node, const std::string& name) {
  const std::filesystem::path path = folder(node) / name;
  if (files_.size() >= kMostFiles) fail(node, "too many files are named");
  if (!std::filesystem::is_regular_file(path))
    fail(node, "the model file cannot be read" + did_you_mean_file(path) + " (value: " + path.string() + ")");
  return open(path);
}

pugi::xml_node XmlFiles::parse_as_part(std::string_view text, const std::filesystem::path& path,
                                       const std::filesystem::path& folder) {
  files_.push_back(std::make_unique<File>());
  File& file = *files_.back();
  file.path = path;
  file.folder = folder;
  file.lines = line_starts(text);
  const pugi::xml_parse_result parsed = file.document.load_buffer(text.data(), text.size());
  if (!parsed && text.find("\"taut-scene/") != text.npos)
    throw ImportError({path.string(), 1}, "is a scene already, which needs no import");
  if (!parsed)
    throw ImportError({path.string(), line_at(file.lines, parsed.offset)},
                      std::string("is no XML: ") + parsed.description());
  file_of_root_[file.document.hash_value()] = &file;
  if (const pugi::xml_node deep = too_deep(file.document))
    fail(deep, "elements are nested too deep (deeper than " + std::to_string(kMostElementsDeep) + ")");
  const pugi::xml_node root = file.document.document_element();
  used_.insert(root.hash_value());
  return root;
}

const XmlFiles::File& XmlFiles::file_of(const pugi::xml_node& node) const {
  return *file_of_root_.at(node.root().hash_value());
}

ModelPlace XmlFiles::place(const pugi::xml_node& node) const {
  const File& file = file_of(node);
  return {file.path.string(), line_at(file.lines, std::max<std::ptrdiff_t>(node.offset_debug(), 0))};
}

std::filesystem::path XmlFiles::folder(const pugi::xml_node& node) const { return file_of(node).folder; }

std::vector<pugi::xml_node> XmlFiles::children(const pugi::xml_node& node) {
  std::vector<pugi::xml_node> result;
  expand(node, result);
  return result;
}

/// A file may be included once only, so that the files cannot include each other for ever.
void XmlFiles::expand(const pugi::xml_node& node, std::vector<pugi::xml_node>& result) {
  for (const pugi::xml_node& child : node.children()) {
    if (child.type() != pugi::node_element) continue;
    const bool includes = std::string_view(child.name()) == "include" && child.attribute("file");
    if (!includes) {
      result.push_back(child);
      continue;
    }
    auto found = included_.find(child.hash_value());
    if (found == included_.end()) {
      const std::filesystem::path path = folder(child) / required(child, "file");
      for (const auto& file : files_)
        if (file->path.lexically_normal() == path.lexically_normal() && file->folder == folder(child))
          fail(child, "the file is included already (value: " + path.string() + ")");
      if (files_.size() >= kMostFiles) fail(child, "too many files are included");
      if (!std::filesystem::is_regular_file(path))
        fail(child, "the included file cannot be read" + did_you_mean_file(path) +
                        " (value: " + path.string() + ")");
      used_.insert(child.hash_value());
      found = included_.emplace(child.hash_value(), parse_as_part(read_text_file(path), path, folder(child)))
                  .first;
    }
    expand(found->second, result);
  }
}

void XmlFiles::know_children(const char* name, const std::vector<std::string>& children) {
  known_children_[name].insert(children.begin(), children.end());
}

/// The same is asked for very often.
void XmlFiles::note_asked(std::map<std::string, std::set<std::string>>& known, const pugi::xml_node& of,
                          std::string_view what) {
  const std::hash<std::string_view> hash;
  const std::size_t of_children = &known == &known_children_ ? 1 : 0;
  if (asked_.insert(31 * (31 * hash(of.name()) + hash(what)) + of_children).second)
    known[of.name()].emplace(what);
}

std::vector<pugi::xml_node> XmlFiles::children(const pugi::xml_node& node, const char* name) {
  note_asked(known_children_, node, name);
  std::vector<pugi::xml_node> result;
  for (const pugi::xml_node& child : children(node))
    if (std::string_view(child.name()) == name) {
      used_.insert(child.hash_value());
      result.push_back(child);
    }
  return result;
}

pugi::xml_node XmlFiles::child(const pugi::xml_node& node, const char* name) {
  note_asked(known_children_, node, name);
  for (const pugi::xml_node& child : children(node))
    if (std::string_view(child.name()) == name) {
      used_.insert(child.hash_value());
      return child;
    }
  return {};
}

const char* XmlFiles::find(const pugi::xml_node& node, const char* attribute) {
  note_asked(known_attributes_, node, attribute);
  const pugi::xml_attribute found = node.attribute(attribute);
  if (!found) return nullptr;
  used_.insert(node.hash_value());
  used_.insert(found.hash_value());
  return found.value();
}

const char* XmlFiles::required(const pugi::xml_node& node, const char* attribute) {
  if (const char* text = find(node, attribute)) return text;
  std::string message = std::string("<") + node.name() + "> needs the attribute \"" + attribute + "\"";
  for (const pugi::xml_attribute& given : node.attributes())
    if (!used_.contains(given.hash_value()) && !did_you_mean(given.name(), {attribute}).empty())
      message += std::string("; is \"") + given.name() + "\" meant to be it?";
  fail(node, message);
}

void XmlFiles::throw_problems() {
  if (problems_.empty()) return;
  throw ImportError(in_order(std::exchange(problems_, {})));
}

void XmlFiles::give_up() {
  is_over_ = true;
  throw_problems();
  throw ImportError({{}, 0}, "cannot be read");  // never: give_up() follows a problem
}

/// A name that is known there, and near.
std::string XmlFiles::meant(const std::map<std::string, std::set<std::string>>& known,
                            const pugi::xml_node& in, std::string_view name) const {
  const auto found = known.find(in.name());
  // Of a symmetric matrix, some write all six others.
  if (found == known.end() || found->second.contains(std::string(name)) || name == "iyx" || name == "izx" ||
      name == "izy")
    return {};
  return did_you_mean(name, {found->second.begin(), found->second.end()});
}

void XmlFiles::accept_all(const pugi::xml_node& node) { accepted_.insert(node.hash_value()); }

std::vector<ImportNotice> XmlFiles::unread() const {
  std::map<std::string, ImportNotice> found;
  const auto note = [&](const std::string& name, const pugi::xml_node& node, const std::string& fate) {
    const auto [entry, added] = found.try_emplace(name + fate, ImportNotice{place(node), name + fate});
    if (!added) ++entry->second.count;
  };
  const auto visit = [&](const auto& self, const pugi::xml_node& node) -> void {
    for (const pugi::xml_attribute& attribute : node.attributes())
      if (!used_.contains(attribute.hash_value()) && !std::string_view(attribute.name()).starts_with("xmlns"))
        note(std::string("<") + node.name() + "> \"" + attribute.name() + '"', node,
             fate_of(node.name(), attribute.name()) + meant(known_attributes_, node, attribute.name()));
    for (const pugi::xml_node& child : node.children()) {
      if (child.type() != pugi::node_element || accepted_.contains(child.hash_value())) continue;
      if (used_.contains(child.hash_value()))
        self(self, child);
      else
        note(std::string("<") + child.name() + '>', child,
             fate_of(child.name(), "") + meant(known_children_, node, child.name()));
    }
  };
  for (const auto& file : files_) visit(visit, file->document.document_element());
  std::vector<ImportNotice> notices;
  for (auto& [name, notice] : found) notices.push_back(std::move(notice));
  return notices;
}

std::vector<double> numbers(XmlFiles& files, const pugi::xml_node& node, const char* attribute,
                            std::string_view text) {
  const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
  std::vector<double> result;
  for (std::size_t at = 0; at < text.size();) {
    if (is_space(text[at])) {
      ++at;
      continue;
    }
    std::size_t end = at;
    while (end < text.size() && !is_space(text[end])) ++end;
    const std::string_view word = text.substr(at, end - at);
    double value = 0;
    const char* first = word.data() + (word.starts_with('+') ? 1 : 0);
    const auto [stop, error] = std::from_chars(first, word.data() + word.size(), value);
    if (error != std::errc() || stop != word.data() + word.size() || !(std::abs(value) <= kLargestNumber))
      files.fail(node, std::string("<") + node.name() + "> \"" + attribute +
                           "\" must be numbers of at most 1e30 (value: " + std::string(word.substr(0, 60)) +
                           ")");
    result.push_back(value);
    at = end;
  }
  return result;
}

}  // namespace taut::model
