"""Conan 2 recipe of the tree that it lies in:  conan create cmake/packaging/conan --build=missing

On Debian 12 with the packages that ./taut run installs, nothing else has to be built:
    conan create cmake/packaging/conan -pr:a cmake/packaging/conan/debian12
"""
import pathlib

from conan import ConanFile
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy, load, rmdir
from conan.tools.system.package_manager import Apt, Dnf, PacMan, Zypper


class TautRecipe(ConanFile):
    name = "taut"
    description = "Rigid multibody systems with very many joints, solved directly"
    license = "BSD-3-Clause"
    topics = ("multibody", "dynamics", "simulation", "contact")
    package_type = "library"
    settings = "os", "arch", "compiler", "build_type"
    options = {"shared": [True, False], "fPIC": [True, False], "program": [True, False]}
    default_options = {"shared": False, "fPIC": True, "program": False, "tinygltf/*:stb_image": False,
                       "tinygltf/*:stb_image_write": False}
    implements = ["auto_shared_fpic"]

    @property
    def _root(self):
        return pathlib.Path(self.recipe_folder).parents[2]

    def set_version(self):
        line = next(line for line in load(self, self._root / "CMakeLists.txt").split("\n") if line.startswith("project(taut"))
        self.version = line.split()[2]

    def export_sources(self):
        for pattern in "CMakeLists.txt", "LICENSE", "cmake/*", "core/*", "collision/*", "solvers/*", "scenes/*":
            copy(self, pattern, self._root, self.export_sources_folder, excludes="*/node_modules/*")

    def requirements(self):
        self.requires("eigen/3.4.0", transitive_headers=True)
        for library in "fcl/0.7.0", "assimp/5.4.3", "nlohmann_json/3.12.0", "tinygltf/2.9.7", "pugixml/1.14", "zlib/[>=1.2.13 <2]":
            self.requires(library)
        if self.options.program:
            self.requires("cli11/2.4.2")
            self.requires("boost/[>=1.74 <2]", options={"header_only": True})

    def system_requirements(self):
        # CHOLMOD has no recipe in ConanCenter: it is the system's.
        Apt(self).install(["libsuitesparse-dev"])
        Dnf(self).install(["suitesparse-devel"])
        Zypper(self).install(["suitesparse-devel"])
        PacMan(self).install(["suitesparse"])

    def validate(self):
        check_min_cppstd(self, 20)

    def layout(self):
        cmake_layout(self)

    def generate(self):
        CMakeDeps(self).generate()
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables.update({"TAUT_BUILD_PROGRAM": bool(self.options.program), "TAUT_BUILD_IO": True,
                                          "TAUT_BUILD_TESTS": False, "TAUT_BUILD_BENCHMARKS": False,
                                          "TAUT_TINYGLTF_HEADER": True})
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()
        copy(self, "LICENSE", self.source_folder, pathlib.Path(self.package_folder, "licenses"))
        rmdir(self, pathlib.Path(self.package_folder, "share", "doc"))

    def package_info(self):
        # taut's own CMake files say what its targets need.
        self.cpp_info.set_property("cmake_find_mode", "none")
        self.cpp_info.builddirs = [str(pathlib.Path("lib", "cmake", "taut"))]
        self.cpp_info.libs = ["taut_io", "taut"]
