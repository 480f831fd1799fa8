#pragma once

#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <pugixml.hpp>
#include <set>
#include <string>
#include <unordered_set>
#include <vector>

#include "core/math/so3.h"
#include "scenes/import/notice.h"

/// XML files of a model: lines of elements, files that include each other, and what nobody has read.
namespace taut::model {

/// Deepest nesting of elements that is read; robots have chains of some 50 links.
inline constexpr int kMostElementsDeep = 400;
/// No number of a model is larger: products of several stay finite.
inline constexpr double kLargestNumber = 1e30;
inline constexpr int kMostFiles = 200;

/// The documents of a model.  What is asked for is noted, so that unread() can name the rest.
class XmlFiles {
 public:
  XmlFiles();
  ~XmlFiles();
  XmlFiles(const XmlFiles&) = delete;
  XmlFiles& operator=(const XmlFiles&) = delete;

  /// The outermost element.
  /// @throws ImportError if the file cannot be read, is no XML, or is nested too deep.
  pugi::xml_node open(const std::filesystem::path& path);
  /// The same from a text, which comes from `path`.
  pugi::xml_node parse(std::string_view text, const std::filesystem::path& path);
  /// A model that this element names, beside its own file.
  pugi::xml_node open_model(const pugi::xml_node& node, const std::string& name);

  ModelPlace place(const pugi::xml_node& node) const;
  /// Where files are that this element names: that of the model, also for elements of a file that it
  /// includes.
  std::filesystem::path folder(const pugi::xml_node& node) const;
  /// The element's children; in place of <include file=""> what the file has in its outermost element.
  std::vector<pugi::xml_node> children(const pugi::xml_node& node);
  /// Those of a name.
  std::vector<pugi::xml_node> children(const pugi::xml_node& node, const char* name);
  /// The first of a name; null if there is none.
  pugi::xml_node child(const pugi::xml_node& node, const char* name);

  /// That, or the same under the name that an extension gives it, such as "drake:capsule".
  pugi::xml_node child_or(const pugi::xml_node& node, const char* name, const char* other) {
    const pugi::xml_node found = child(node, name);
    return found ? found : child(node, other);
  }

  /// The attribute's text, which counts as read; null if there is none.
  const char* find(const pugi::xml_node& node, const char* attribute);
  const char* required(const pugi::xml_node& node, const char* attribute);
  /// The element counts as read; its attributes that nobody asks for do not.
  void accept(const pugi::xml_node& node) { used_.insert(node.hash_value()); }
  /// The element counts as read, with all that is in it.
  void accept_all(const pugi::xml_node& node);
  [[noreturn]] void fail(const pugi::xml_node& node, const std::string& message) const {
    throw ImportError(place(node), message);
  }

  /// Reads a part of a model.  What is wrong with it is kept for throw_problems(), and reading goes on, up to
  /// kMostProblems.  @returns whether all is well with it.
  template <typename Read>
  bool attempt(Read read) {
    try {
      read();
      return true;
    } catch (const ImportError& error) {
      if (is_over_) throw;
      problems_.insert(problems_.end(), error.problems().begin(), error.problems().end());
      if (problems_.size() >= kMostProblems) give_up();
      return false;
    }
  }
  /// @throws ImportError of all that attempt() has kept, if there is any.
  void throw_problems();
  /// No attempt() goes on after this.
  [[noreturn]] void give_up(const pugi::xml_node& node, const std::string& message) {
    problems_.push_back({place(node), message, 1});
    give_up();
  }

  /// Elements that an element of this name may have, where all its children are read by one function.
  void know_children(const char* name, const std::vector<std::string>& children);
  /// Elements and attributes that nobody has asked for, by name.  What is in such an element is not named.
  std::vector<ImportNotice> unread() const;

 private:
  struct File;
  pugi::xml_node parse_as_part(std::string_view text, const std::filesystem::path& path,
                               const std::filesystem::path& folder);
  const File& file_of(const pugi::xml_node& node) const;
  void expand(const pugi::xml_node& node, std::vector<pugi::xml_node>& result);
  [[noreturn]] void give_up();
  void note_asked(std::map<std::string, std::set<std::string>>& known, const pugi::xml_node& of,
                  std::string_view what);
  std::string meant(const std::map<std::string, std::set<std::string>>& known, const pugi::xml_node& in,
                    std::string_view name) const;

  std::deque<std::unique_ptr<File>> files_;
  std::map<std::size_t, File*> file_of_root_;                 // by hash of the document
  std::unordered_map<std::size_t, pugi::xml_node> included_;  // by hash of the <include>
  std::unordered_set<std::size_t> used_, accepted_;
  std::vector<ImportNotice> problems_;
  bool is_over_ = false;
  /// By the name of an element: what was asked for of it.
  std::map<std::string, std::set<std::string>> known_attributes_, known_children_;
  std::unordered_set<std::size_t> asked_;  // hashes of what is among them
};

/// Numbers of a text, separated by white space.
/// @throws ImportError naming the attribute and its text if one is no finite number.
std::vector<double> numbers(XmlFiles& files, const pugi::xml_node& node, const char* attribute,
                            std::string_view text);

}  // namespace taut::model
