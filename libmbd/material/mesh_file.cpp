#include "libmbd/material/mesh_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <memory>
#include <string>

#include "libmbd/core/error.hpp"

#ifdef MBD_ASSIMP_LIBRARY
#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <dlfcn.h>
#endif

namespace mbd {

#ifdef MBD_ASSIMP_LIBRARY
namespace {

// Loaded when the first file is read; the names are those of its C interface.
struct Importer {
  decltype(&aiCreatePropertyStore) create_store = nullptr;
  decltype(&aiReleasePropertyStore) release_store = nullptr;
  decltype(&aiSetImportPropertyInteger) set = nullptr;
  decltype(&aiImportFileExWithProperties) import = nullptr;
  decltype(&aiReleaseImport) release = nullptr;
  decltype(&aiGetErrorString) error = nullptr;

  Importer() {
    void* const library = dlopen(MBD_ASSIMP_LIBRARY, RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr)
      throw Error(
          fmt::format("{} could not be loaded ({}); install libassimp5, or leave the mesh out",
                      MBD_ASSIMP_LIBRARY, dlerror()));
    const auto find = [&](auto& function, const char* name) {
      function = reinterpret_cast<std::decay_t<decltype(function)>>(dlsym(library, name));
      if (function == nullptr)
        throw Error(fmt::format("{} has no {}; install libassimp5", MBD_ASSIMP_LIBRARY, name));
    };
    find(create_store, "aiCreatePropertyStore");
    find(release_store, "aiReleasePropertyStore");
    find(set, "aiSetImportPropertyInteger");
    find(import, "aiImportFileExWithProperties");
    find(release, "aiReleaseImport");
    find(error, "aiGetErrorString");
  }
};

// Points that are at one place are one; so triangles know their neighbours.
TriangleMesh joined(const aiScene& scene, const std::string& file) {
  TriangleMesh made;
  std::map<std::array<float, 3>, std::uint32_t> known;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    std::vector<std::uint32_t> number(mesh.mNumVertices);
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const aiVector3D& x = mesh.mVertices[i];
      const Vec3 point(x.x, x.y, x.z);
      if (!point.allFinite())
        throw Error(fmt::format(
            "{}: a point has coordinates that are no numbers; mend it, or leave the mesh out",
            file));
      // + 0: no negative zeros.
      const auto [it, is_new] = known.try_emplace({x.x + 0.0F, x.y + 0.0F, x.z + 0.0F},
                                                  static_cast<std::uint32_t>(made.points.size()));
      if (is_new) made.points.push_back(point);
      number[i] = it->second;
    }
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;  // points and lines
      const std::array<std::uint32_t, 3> t{number[face.mIndices[0]], number[face.mIndices[1]],
                                           number[face.mIndices[2]]};
      if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) made.triangles.push_back(t);
    }
  }
  return made;
}

}  // namespace

TriangleMesh read_mesh_file(const std::filesystem::path& path) {
  const std::string file = path.string();
  std::string kind = path.extension().string();
  std::ranges::transform(kind, kind.begin(), [](unsigned char c) { return std::tolower(c); });
  constexpr std::array<std::string_view, 4> kinds{".stl", ".obj", ".gltf", ".glb"};
  if (std::ranges::find(kinds, kind) == kinds.end())
    throw Error(fmt::format(
        "{}: meshes are read from .stl, .obj, .gltf and .glb files; convert it to one of them",
        file));
  std::error_code code;
  if (!std::filesystem::is_regular_file(path, code))
    throw Error(
        fmt::format("{}: there is no such file; give its name from the model's directory", file));
  constexpr std::uintmax_t most_bytes = 64U << 20U;
  if (std::filesystem::file_size(path, code) > most_bytes || code)
    throw Error(
        fmt::format("{}: it is larger than 64 MB; make the mesh coarser, it is for the eye", file));
  static const Importer importer;
  // Only positions matter: what else points have would keep those at one place apart.
  const std::unique_ptr<aiPropertyStore, decltype(importer.release_store)> store(
      importer.create_store(), importer.release_store);
  importer.set(store.get(), AI_CONFIG_PP_RVC_FLAGS,
               aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_COLORS |
                   aiComponent_TEXCOORDS | aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS |
                   aiComponent_TEXTURES | aiComponent_LIGHTS | aiComponent_CAMERAS |
                   aiComponent_MATERIALS);
  const std::unique_ptr<const aiScene, decltype(importer.release)> scene(
      importer.import(file.c_str(),
                      aiProcess_RemoveComponent | aiProcess_Triangulate |
                          aiProcess_PreTransformVertices | aiProcess_SortByPType,
                      nullptr, store.get()),
      importer.release);
  if (!scene)
    throw Error(
        fmt::format("{}: it is not to be read as a mesh: {}; write it anew, or leave the mesh out",
                    file, importer.error()));
  TriangleMesh made = joined(*scene, file);
  if (made.triangles.empty())
    throw Error(fmt::format("{}: it has no triangles; give a surface", file));
  if (made.triangles.size() > most_triangles)
    throw Error(fmt::format("{}: it has {} triangles, {} at most; make it coarser", file,
                            made.triangles.size(), most_triangles));
  return made;
}

#else

TriangleMesh read_mesh_file(const std::filesystem::path& path) {
  throw Error(fmt::format(
      "{}: this build reads no meshes: libassimp (Debian: libassimp-dev) was not there when it was "
      "made; leave the mesh out or build it again",
      path.string()));
}

#endif

}  // namespace mbd
