#include "scenes/files/friction_hdf5.h"

#include "core/base/check.h"

#ifdef TAUT_HDF5
#include <hdf5.h>

#include <limits>
#include <vector>
#endif

namespace taut {

#ifdef TAUT_HDF5
namespace {

using Matrix = FrictionProblem::Matrix;
using Vector = Eigen::VectorXd;

/// What HDF5 opened, closed at the end of its scope.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Entries of a matrix, made of the arrays that a file gives.
struct SparseEntries {
  const std::string& file;
  const std::string& path;  // of the matrix in it
  int rows, columns;
  std::vector<Eigen::Triplet<double>> entries = {};

  void add(int row, int column, double value) {
    if (row < 0 || row >= rows || column < 0 || column >= columns)
      fail(file, path + ": index out of range", row);
    entries.emplace_back(row, column, value);
  }
  void require(std::size_t have, std::size_t wanted) const {
    if (have < wanted) fail(file, path + ": has too few entries", have);
  }
  void add_triplets(int count, const std::vector<int>& p, const std::vector<int>& i, const Vector& x) {
    for (const std::size_t have : {p.size(), i.size(), static_cast<std::size_t>(x.size())})
      require(have, count);
    // FCLIB's own description has row and column the other way round than the files.
    bool swapped = false;
    for (int k = 0; k < count; ++k) swapped = swapped || i[k] >= rows || p[k] >= columns;
    for (int k = 0; k < count; ++k) swapped ? add(p[k], i[k], x[k]) : add(i[k], p[k], x[k]);
  }
  void add_compressed(bool by_rows, const std::vector<int>& p, const std::vector<int>& i, const Vector& x) {
    const int outer = by_rows ? rows : columns;
    require(p.size(), static_cast<std::size_t>(outer) + 1);
    for (int o = 0; o < outer; ++o) {
      if (p[o] < 0 || p[o] > p[o + 1]) fail(file, path + ": pointers must ascend", p[o]);
      require(i.size(), p[o + 1]);
      require(x.size(), p[o + 1]);
      for (int k = p[o]; k < p[o + 1]; ++k) by_rows ? add(o, i[k], x[k]) : add(i[k], o, x[k]);
    }
  }
};

/// A file of FCLIB, read by the names of its data.
class FclibFile {
 public:
  explicit FclibFile(const std::string& name)
      : name_(name), file_(H5Fopen(name.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose) {
    if (file_ < 0) fail(name, "cannot be read as HDF5", "H5Fopen");
  }

  /// Also where a part of the way is not there.
  bool has(const std::string& path) const {
    for (std::size_t end = path.find('/'); end != std::string::npos; end = path.find('/', end + 1))
      if (H5Lexists(file_, path.substr(0, end).c_str(), H5P_DEFAULT) <= 0) return false;
    return H5Lexists(file_, path.c_str(), H5P_DEFAULT) > 0;
  }
  template <typename Value>
  std::vector<Value> values(const std::string& path, hid_t type) const {
    if (!has(path)) fail(name_, "a part is missing", path);
    const Handle set(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose);
    if (set < 0) fail(name_, "is no set of numbers", path);
    const Handle space(H5Dget_space(set), H5Sclose), kind(H5Dget_type(set), H5Tclose);
    const hssize_t size = H5Sget_simple_extent_npoints(space);
    const H5T_class_t numbers = H5Tget_class(kind);
    // Contiguous data cannot be larger than the file; compressed data are refused where they are beyond
    // reason.
    constexpr hssize_t kMostNumbers = hssize_t{1} << 27;
    if (size < 0 || size > kMostNumbers || (numbers != H5T_INTEGER && numbers != H5T_FLOAT))
      fail(name_, "is no set of numbers", path);
    std::vector<Value> out(size);
    if (size > 0 && H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data()) < 0)
      fail(name_, "cannot be read", path);
    return out;
  }
  std::vector<int> integers(const std::string& path) const { return values<int>(path, H5T_NATIVE_INT); }
  int integer(const std::string& path) const {
    const auto all = integers(path);
    if (all.empty()) fail(name_, "has no value", path);
    return all[0];
  }
  Vector vector(const std::string& path) const {
    const auto all = values<double>(path, H5T_NATIVE_DOUBLE);
    return Eigen::Map<const Vector>(all.data(), static_cast<Eigen::Index>(all.size()));
  }

  /// nz = −2: compressed rows; −1: compressed columns; else so many triplets (i, p) of row and column.
  Matrix matrix(const std::string& path) const {
    const int rows = integer(path + "/m"), columns = integer(path + "/n"), nz = integer(path + "/nz");
    const std::vector<int> p = integers(path + "/p"), i = integers(path + "/i");
    const Vector x = vector(path + "/x");
    if (rows < 0 || columns < 0 || nz < -2) fail(name_, "must not be negative", path);
    SparseEntries read{name_, path, rows, columns};
    if (nz >= 0)
      read.add_triplets(nz, p, i, x);
    else
      read.add_compressed(nz == -2, p, i, x);
    Matrix A(rows, columns);
    A.setFromTriplets(read.entries.begin(), read.entries.end());
    return A;
  }

 private:
  const std::string& name_;
  Handle file_;
};

/// A at (row, column) of something larger.
void place(const Matrix& A, int row, int column, std::vector<Eigen::Triplet<double>>& entries) {
  for (int k = 0; k < A.outerSize(); ++k)
    for (Matrix::InnerIterator at(A, k); at; ++at)
      entries.emplace_back(row + static_cast<int>(at.row()), column + static_cast<int>(at.col()), at.value());
}

Vector joined(const Vector& a, const Vector& b) {
  Vector both(a.size() + b.size());
  both << a, b;
  return both;
}

void require_size(const std::string& name, const char* what, Eigen::Index is, Eigen::Index wanted) {
  if (is != wanted)
    fail(name, std::string("the size of ").append(what).append(" must be ").append(std::to_string(wanted)),
         is);
}

FrictionFile read_local(const FclibFile& in, const std::string& name) {
  const Matrix W = in.matrix("fclib_local/W");
  const Vector q = in.vector("fclib_local/vectors/q"), mu = in.vector("fclib_local/vectors/mu");
  FrictionFile file{.problem = {}, .form = "local", .dimension = in.integer("fclib_local/spacedim")};
  if (file.dimension != 2 && file.dimension != 3) fail(name, "the dimension must be 2 or 3", file.dimension);
  require_size(name, "W", W.rows(), file.dimension * mu.size());
  require_size(name, "W", W.cols(), W.rows());
  require_size(name, "q", q.size(), W.rows());
  // With equalities:  u = W r + V λ + q,  0 = Vᵀ r + R λ + s.
  std::vector<Eigen::Triplet<double>> entries;
  Vector s(0);
  int equalities = 0;
  if (in.has("fclib_local/V")) {
    const Matrix V = in.matrix("fclib_local/V"), R = in.matrix("fclib_local/R");
    s = in.vector("fclib_local/vectors/s");
    equalities = static_cast<int>(V.cols());
    require_size(name, "V", V.rows(), W.rows());
    require_size(name, "R", R.rows(), equalities);
    require_size(name, "R", R.cols(), equalities);
    require_size(name, "s", s.size(), equalities);
    place(R, 0, 0, entries);
    place(V, equalities, 0, entries);
    place(V.transpose(), 0, equalities, entries);
  }
  place(W, equalities, equalities, entries);
  Matrix all(equalities + W.rows(), equalities + W.rows());
  all.setFromTriplets(entries.begin(), entries.end());
  const Vector all_q = joined(s, q);
  if (file.dimension == 2)
    file.problem = with_second_tangents(all, all_q, mu, equalities);
  else
    file.problem = {.W = all, .q = all_q, .mu = mu, .equalities = equalities};
  return file;
}

FrictionFile read_global(const FclibFile& in, const std::string& name) {
  FrictionFile file{.problem = {}, .form = "global", .dimension = in.integer("fclib_global/spacedim")};
  if (file.dimension != 3) fail(name, "a global problem must have three dimensions", file.dimension);
  GlobalFrictionProblem global{.M = in.matrix("fclib_global/M"),
                               .H = in.matrix("fclib_global/H"),
                               .f = in.vector("fclib_global/vectors/f"),
                               .b = in.vector("fclib_global/vectors/w"),
                               .mu = in.vector("fclib_global/vectors/mu")};
  if (in.has("fclib_global/G")) {
    const Matrix G = in.matrix("fclib_global/G");
    require_size(name, "G", G.rows(), global.M.rows());
    std::vector<Eigen::Triplet<double>> entries;
    place(G, 0, 0, entries);
    place(global.H, 0, static_cast<int>(G.cols()), entries);
    global.equalities = static_cast<int>(G.cols());
    Matrix all(G.rows(), G.cols() + global.H.cols());
    all.setFromTriplets(entries.begin(), entries.end());
    global.H = all;
    global.b = joined(in.vector("fclib_global/vectors/b"), global.b);
  }
  file.problem = global.condensed();
  return file;
}

}  // namespace

bool reads_hdf5() { return true; }

FrictionFile read_friction_hdf5(const std::filesystem::path& path) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // it would print
  const std::string name = path.string();
  const FclibFile in(name);
  FrictionFile file;
  if (in.has("fclib_local"))
    file = read_local(in, name);
  else if (in.has("fclib_global"))
    file = read_global(in, name);
  else
    fail(name, "has neither a group fclib_local nor fclib_global", "HDF5");
  file.problem.require_valid();
  return file;
}

#else

bool reads_hdf5() { return false; }

FrictionFile read_friction_hdf5(const std::filesystem::path& path) {
  fail(path.string(), "this build reads no HDF5; on Debian: apt-get install libhdf5-dev, then build again",
       "HDF5");
}

#endif

}  // namespace taut
