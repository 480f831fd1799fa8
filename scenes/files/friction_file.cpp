#include "scenes/files/friction_file.h"

#include <charconv>
#include <cmath>
#include <fstream>
#include <set>
#include <string_view>
#include <vector>

#include "core/base/check.h"
#include "scenes/files/friction_hdf5.h"
#include "scenes/files/scene_file.h"
#include "scenes/support/format.h"

namespace taut {
namespace {

using Matrix = FrictionProblem::Matrix;
using Vector = Eigen::VectorXd;
using Entries = std::vector<Eigen::Triplet<double>>;

/// The numbers of a text, one after the other.  No count is believed before so many characters are there.
class Numbers {
 public:
  Numbers(std::string_view text, const std::string& name) : text_(text), name_(name) { skip(); }

  double real(const char* what) { return next<double>(what, "a number"); }
  int integer(const char* what) { return next<int>(what, "a whole number"); }
  int count(const char* what) {
    const int value = integer(what);
    if (value < 0) fail(name_, std::string("the ").append(what).append(" must not be negative"), value);
    if (static_cast<std::size_t>(value) > text_.size())
      fail(name_, std::string("ends before the ").append(what), value);
    return value;
  }
  Vector reals(Eigen::Index n, const char* what) {
    if (static_cast<std::size_t>(n) > text_.size())
      fail(name_, std::string("ends before the ").append(what), n);
    Vector values(n);
    for (double& value : values) value = real(what);
    return values;
  }
  std::vector<int> integers(int n, const char* what) {
    if (static_cast<std::size_t>(n) > text_.size())
      fail(name_, std::string("ends before the ").append(what), n);
    std::vector<int> values(n);
    for (int& value : values) value = integer(what);
    return values;
  }
  /// How many more there are.
  int left() const {
    int count = 0;
    bool within = false;
    for (const char c : text_) {
      if (!is_space(c) && !within) ++count;
      within = !is_space(c);
    }
    return count;
  }
  const std::string& name() const { return name_; }

 private:
  static bool is_space(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v';
  }
  void skip() {
    std::size_t i = 0;
    while (i < text_.size() && is_space(text_[i])) ++i;
    text_.remove_prefix(i);
  }
  template <typename Value>
  Value next(const char* what, const char* kind) {
    std::size_t size = 0;
    while (size < text_.size() && !is_space(text_[size])) ++size;
    std::string_view word = text_.substr(0, size);
    if (size == 0) fail(name_, std::string("ends before the ").append(what), "end of file");
    Value value{};
    const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size())
      fail(name_, std::string("the ").append(what).append(" must be ").append(kind), word.substr(0, 40));
    text_.remove_prefix(size);
    skip();
    return value;
  }

  std::string_view text_;
  const std::string& name_;
};

Matrix matrix_of(int rows, int columns, const Entries& entries) {
  Matrix A(rows, columns);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

Matrix read_dense(Numbers& numbers, int rows, int columns) {
  if (numbers.count("rows of a matrix") != rows || numbers.count("columns of a matrix") != columns)
    fail(numbers.name(), "a dense matrix must repeat its size", rows);
  Entries entries;
  for (int c = 0; c < columns; ++c)
    for (int r = 0; r < rows; ++r)
      if (const double value = numbers.real("entry of a dense matrix"); value != 0)
        entries.emplace_back(r, c, value);
  return matrix_of(rows, columns, entries);
}

/// Ends of blocks, as starts.
std::vector<int> starts(Numbers& numbers, int count, int size, const char* what) {
  std::vector<int> at{0};
  for (const int end : numbers.integers(count, what)) {
    if (end < at.back() || end > size)
      fail(numbers.name(), std::string("the ").append(what).append(" must ascend"), end);
    at.push_back(end);
  }
  if (at.back() != size)
    fail(numbers.name(), std::string("the ").append(what).append(" must end with the matrix"), at.back());
  return at;
}

Matrix read_blocks(Numbers& numbers, int rows, int columns) {
  const int blocks = numbers.count("number of blocks"), block_rows = numbers.count("number of block rows"),
            block_columns = numbers.count("number of block columns");
  const auto row = starts(numbers, block_rows, rows, "ends of block rows"),
             column = starts(numbers, block_columns, columns, "ends of block columns");
  const int pointers = numbers.count("number of row pointers"),
            indices = numbers.count("number of block indices");
  const std::vector<int> pointer = numbers.integers(pointers, "row pointers"),
                         index = numbers.integers(indices, "block indices");
  Entries entries;
  int read = 0;
  for (int b = 0; b + 1 < pointers; ++b)
    for (int k = pointer[b]; k < pointer[b + 1]; ++k, ++read) {
      if (k != read || k >= indices || b >= block_rows)
        fail(numbers.name(), "the row pointers must ascend from 0", k);
      if (index[k] < 0 || index[k] >= block_columns)
        fail(numbers.name(), "there is no block column of that index", index[k]);
      if (const int named = numbers.integer("index of a block"); named != k)
        fail(numbers.name(), std::string("the block must have the index ").append(std::to_string(k)), named);
      for (int c = column[index[k]]; c < column[index[k] + 1]; ++c)
        for (int r = row[b]; r < row[b + 1]; ++r)
          entries.emplace_back(r, c, numbers.real("entry of a block"));
    }
  if (read != blocks)
    fail(numbers.name(),
         std::string("must have as many blocks as rows point to, ").append(std::to_string(read)), blocks);
  return matrix_of(rows, columns, entries);
}

Matrix read_matrix(Numbers& numbers) {
  const int storage = numbers.integer("storage of a matrix"), rows = numbers.count("rows of a matrix"),
            columns = numbers.count("columns of a matrix");
  if (storage == 0) return read_dense(numbers, rows, columns);
  if (storage == 1) return read_blocks(numbers, rows, columns);
  fail(numbers.name(), "the storage of a matrix must be 0 (dense) or 1 (blocks)", storage);
}

/// Whether so many numbers are left that they are `wanted`, or with a flag behind them one more.
bool ends_with(const Numbers& numbers, long wanted) {
  const long more = numbers.left() - wanted;
  return more == 0 || more == 1;
}

bool is_hdf5(const std::filesystem::path& file) {
  constexpr std::string_view kMagic("\x89HDF\r\n\x1a\n", 8);
  char start[8] = {};
  std::ifstream in(file, std::ios::binary);
  return in.read(start, sizeof start) && std::string_view(start, sizeof start) == kMagic;
}

/// Which blocks of contacts W has, by rows.
struct BlockPattern {
  std::vector<int> start{0}, column;

  explicit BlockPattern(const Matrix& W) {
    for (int k = 0; 3 * k < W.rows(); ++k) {
      std::set<int> met;
      for (int i = 3 * k; i < 3 * k + 3; ++i)
        for (Matrix::InnerIterator at(W, i); at; ++at) met.insert(static_cast<int>(at.col()) / 3);
      column.insert(column.end(), met.begin(), met.end());
      start.push_back(static_cast<int>(column.size()));
    }
  }
};

void append_numbers(std::string& text, const Vector& values) {
  for (const double value : values) text += format("%.17g ", value);
  text += '\n';
}

}  // namespace

FrictionProblem with_second_tangents(const Matrix& W, const Vector& q, const Vector& mu, int equalities) {
  const int contacts = static_cast<int>(mu.size());
  const auto row = [&](int i) { return i < equalities ? i : i + (i - equalities) / 2; };
  Entries entries;
  double trace = 0;
  for (int i = 0; i < W.outerSize(); ++i)
    for (Matrix::InnerIterator at(W, i); at; ++at) {
      entries.emplace_back(row(i), row(static_cast<int>(at.col())), at.value());
      if (at.col() == i && i >= equalities) trace += at.value() / (2.0 * contacts);
    }
  FrictionProblem problem{
      .W = {}, .q = Vector::Zero(equalities + 3 * contacts), .mu = mu, .equalities = equalities};
  for (int i = 0; i < q.size(); ++i) problem.q[row(i)] = q[i];
  for (int k = 0; k < contacts; ++k)
    entries.emplace_back(equalities + 3 * k + 2, equalities + 3 * k + 2, trace);
  problem.W = matrix_of(problem.rows(), problem.rows(), entries);
  return problem;
}

FrictionFile parse_friction_text(std::string_view text, const std::string& name) {
  Numbers numbers(text, name);
  const int dimension = numbers.integer("dimension"), contacts = numbers.count("number of contacts");
  if (dimension != 2 && dimension != 3) fail(name, "the dimension must be 2 or 3", dimension);
  const Matrix first = read_matrix(numbers);
  const long m = first.rows(), n = static_cast<long>(dimension) * contacts;
  FrictionFile file{.problem = {}, .form = "local", .dimension = dimension};
  // What is left says which of the two forms it is.
  if (m == n && ends_with(numbers, m + contacts)) {
    const Vector q = numbers.reals(m, "vector q"), mu = numbers.reals(contacts, "coefficients of friction");
    if (dimension == 2)
      file.problem = with_second_tangents(first, q, mu, 0);
    else
      file.problem = {.W = first, .q = q, .mu = mu};
  } else {
    file.form = "global";
    if (dimension != 3) fail(name, "a global problem must have three dimensions", dimension);
    GlobalFrictionProblem global{.M = first, .H = read_matrix(numbers), .f = {}, .b = {}, .mu = {}};
    global.f = numbers.reals(m, "vector f");
    global.b = numbers.reals(n, "vector b");
    global.mu = numbers.reals(contacts, "coefficients of friction");
    file.problem = global.condensed();
  }
  if (numbers.left() > 1) fail(name, "goes on behind its end", numbers.left());
  file.problem.require_valid();
  return file;
}

std::string friction_text(const FrictionProblem& problem) {
  problem.require_valid();
  if (problem.equalities > 0) fail("equalities", "have no place in the text form", problem.equalities);
  const int contacts = problem.contacts(), rows = problem.rows();
  const BlockPattern blocks(problem.W);
  std::string text = format("3\n%d\n1 %d %d\n%d %d %d\n", contacts, rows, rows,
                            static_cast<int>(blocks.column.size()), contacts, contacts);
  for (int twice = 0; twice < 2; ++twice) {
    for (int k = 0; k < contacts; ++k) text += format("%d ", 3 * k + 3);
    text += '\n';
  }
  text += format("%d %d\n", contacts + 1, static_cast<int>(blocks.column.size()));
  for (const auto* list : {&blocks.start, &blocks.column}) {
    for (const int index : *list) text += format("%d ", index);
    text += '\n';
  }
  for (int k = 0, b = 0; k < contacts; ++k)
    for (; b < blocks.start[k + 1]; ++b) {
      text += format("%d\n", b);
      const Eigen::Matrix3d block =
          Matrix(problem.W.middleRows(3 * k, 3)).middleCols(3 * blocks.column[b], 3);
      append_numbers(text, Eigen::Map<const Vector>(block.data(), 9));
    }
  append_numbers(text, problem.q);
  append_numbers(text, problem.mu);
  return text;
}

FrictionFile read_friction_file(const std::filesystem::path& file) {
  try {
    return is_hdf5(file) ? read_friction_hdf5(file)
                         : parse_friction_text(read_text_file(file), file.string());
  } catch (const std::invalid_argument& error) {
    const std::string message = error.what(), name = file.string();
    if (message.starts_with(name)) throw;
    throw std::invalid_argument(name + ": " + message);
  }
}

}  // namespace taut
