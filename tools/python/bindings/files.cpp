#include "mallow/files.h"

#include <pybind11/functional.h>

#include "mallow/level_set.h"
#include "meshes.h"
#include "parts.h"

namespace mallow::python {

py::object surface_particles_of(const ParticleFrame& frame, std::span<const float> spacings);

namespace {

using Path = std::filesystem::path;
using Bodies = std::vector<MeshBody>;

void bind_choices(py::module_& module) {
  choice<UpAxis>(module, "UpAxis", {{"y", UpAxis::y}, {"z", UpAxis::z}});
  choice<GlbPacking>(module, "GlbPacking",
                     {{"quantized", GlbPacking::quantized}, {"meshopt", GlbPacking::meshopt}});
  module.def("can_compress_glb", &can_compress_glb, doc("can_compress_glb"));
  module.def("with_y_up", &with_y_up, py::arg("v"), doc("with_y_up"));
}

void bind_structs(py::module_& module) {
  Struct<ParticleFrame>(module, "ParticleFrame", Change::live)
      .field("positions", &ParticleFrame::positions, "", "an array of n x 3 numbers")
      .field("velocities", &ParticleFrame::velocities, "", "an array of n x 3 numbers")
      .field("bodies", &ParticleFrame::bodies, "", "an array of whole numbers")
      .field("time", &ParticleFrame::time)
      .field("step", &ParticleFrame::step)
      .field("ids", &ParticleFrame::ids, "", "an array of whole numbers")
      .field("alphas", &ParticleFrame::alphas, "", "an array of numbers")
      .field("temperatures", &ParticleFrame::temperatures, "", "an array of numbers")
      .done();
  Struct<MeshBody>(module, "MeshBody", Change::frozen)
      .field("appearance", &MeshBody::appearance, "", "an Appearance")
      .field("name", &MeshBody::name, "", "a name")
      .field("material", &MeshBody::material, "", "a name")
      .done();
  Struct<MeshPose>(module, "MeshPose", Change::frozen)
      .field("time", &MeshPose::time)
      .field("vertices", &MeshPose::vertices, "", "an array of n x 3 numbers")
      .field("normals", &MeshPose::normals, "", "an array of n x 3 numbers")
      .done();
  Struct<UsdOptions>(module, "UsdOptions", Change::frozen)
      .field("up", &UsdOptions::up)
      .field("frames_per_second", &UsdOptions::frames_per_second)
      .field("speed", &UsdOptions::speed)
      .done();
  Struct<TimedFile>(module, "TimedFile", Change::frozen)
      .field("file", &TimedFile::file, "", "a path")
      .field("time", &TimedFile::time)
      .done();
  Struct<UsdFrame>(module, "UsdFrame", Change::frozen)
      .field("file", &UsdFrame::file, "", "a path")
      .field("number", &UsdFrame::number)
      .done();
}

void bind_particles(py::module_& module) {
  module.def("read_points", &read_points, py::arg("file"), py::arg("spacing"), doc("read_points"));
  module.def(
      "snapshot",
      [](SimulationCell& cell) {
        const Use use = reading(cell);
        return snapshot(cell.simulation);
      },
      py::arg("simulation"), doc("snapshot"));
  module.def(
      "surface_particles",
      [](const ParticleFrame& frame, const std::vector<float>& spacings) {
        return surface_particles_of(frame, spacings);
      },
      py::arg("frame"), py::arg("spacings"), doc("surface_particles"));
  const auto writer = [&](const char* name, auto write) {
    module.def(name, write, py::arg("file"), py::arg("frame"), doc(name));
  };
  writer("write_particles", &write_particles);
  writer("write_state_csv", &write_state_csv);
  module.def(
      "write_particles_vtp",
      [](const Path& file, const ParticleFrame& frame, const Bodies& bodies) {
        write_particles_vtp(file, frame, bodies);
      },
      py::arg("file"), py::arg("frame"), py::arg("bodies") = Bodies{}, doc("write_particles_vtp"));
  module.def("read_particles", &read_particles, py::arg("file"), doc("read_particles"));
  module.def("write_particles_vdb", &write_particles_vdb, py::arg("file"), py::arg("frame"),
             py::arg("voxel_size"), py::arg("threads") = 0, doc("write_particles_vdb"));
  module.def(
      "points_vdb",
      [](const std::vector<Vec3>& positions, const std::vector<Vec3>& velocities,
         const std::vector<std::uint32_t>& bodies, float voxel_size,
         int threads) { return py::bytes(points_vdb(positions, velocities, bodies, voxel_size, threads)); },
      py::arg("positions"), py::arg("velocities"), py::arg("bodies"), py::arg("voxel_size"),
      py::arg("threads") = 0, doc("points_vdb"));
}

void bind_mesh_files(py::module_& module) {
  module.def(
      "read_mesh", [](const Path& file) { return MeshObject(read_mesh(file)); }, py::arg("file"),
      doc("read_mesh"));
  module.def(
      "read_mesh",
      [](const Path& file, Eigen::Vector3d origin) {
        Mesh mesh = read_mesh(file, origin);
        return std::pair(MeshObject(std::move(mesh)), origin);
      },
      py::arg("file"), py::kw_only(), py::arg("origin"), doc("read_mesh#2"));
  module.def(
      "write_mesh_ply",
      [](const Path& file, const MeshObject& mesh) { write_mesh_ply(file, mesh.checked()); }, py::arg("file"),
      py::arg("mesh"), doc("write_mesh_ply"));
  module.def(
      "write_mesh_vtp",
      [](const Path& file, const MeshObject& mesh, const Bodies& bodies) {
        write_mesh_vtp(file, mesh.checked(), bodies);
      },
      py::arg("file"), py::arg("mesh"), py::arg("bodies") = Bodies{}, doc("write_mesh_vtp"));
  module.def(
      "write_mesh_obj",
      [](const Path& file, const MeshObject& mesh, UpAxis up, const Bodies& bodies,
         const Path& material_library) {
        write_mesh_obj(file, mesh.checked(),
                       {.up = up, .bodies = bodies, .material_library = material_library});
      },
      py::arg("file"), py::arg("mesh"), py::arg("up") = UpAxis::z, py::arg("bodies") = Bodies{},
      py::arg("material_library") = "", doc("write_mesh_obj"));
  module.def(
      "write_mtl", [](const Path& file, const Bodies& bodies) { write_mtl(file, bodies); }, py::arg("file"),
      py::arg("bodies"), doc("write_mtl"));
  module.def(
      "write_mesh_glb",
      [](const Path& file, const MeshObject& mesh, const Bodies& bodies) {
        write_mesh_glb(file, mesh.checked(), bodies);
      },
      py::arg("file"), py::arg("mesh"), py::arg("bodies"), doc("write_mesh_glb"));
  module.def(
      "write_animation_glb",
      [](const Path& file, const MeshObject& mesh, const std::vector<MeshPose>& poses, const Bodies& bodies) {
        write_animation_glb(file, mesh.checked(), poses, bodies);
      },
      py::arg("file"), py::arg("mesh"), py::arg("poses"), py::arg("bodies"), doc("write_animation_glb"));
}

void bind_series(py::module_& module) {
  py::class_<GlbSeries>(module, "GlbSeries", doc("GlbSeries"))
      .def(py::init([](const Bodies& bodies, GlbPacking packing) { return GlbSeries(bodies, packing); }),
           py::arg("bodies"), py::arg("packing") = GlbPacking::quantized, doc("GlbSeries.__init__"))
      .def(
          "add",
          [](GlbSeries& series, const MeshObject& mesh, double time) { series.add(mesh.checked(), time); },
          py::arg("mesh"), py::arg("time"), doc("GlbSeries.add"))
      .def("frames", &GlbSeries::frames, doc("GlbSeries.frames"))
      .def(
          "write", [](GlbSeries& series, const Path& file) { std::move(series).write(file); },
          py::arg("file"), doc("GlbSeries.write"));
  module.def(
      "write_mesh_usda",
      [](const Path& file, const MeshObject& mesh, const Bodies& bodies, const UsdOptions& options,
         std::optional<int> frame) { write_mesh_usda(file, mesh.checked(), bodies, options, frame); },
      py::arg("file"), py::arg("mesh"), py::arg("bodies"), py::arg_v("options", UsdOptions{}, "UsdOptions()"),
      py::arg("frame") = std::nullopt, doc("write_mesh_usda"));
  module.def(
      "write_pvd", [](const Path& file, const std::vector<TimedFile>& frames) { write_pvd(file, frames); },
      py::arg("file"), py::arg("frames"), doc("write_pvd"));
  module.def("usda_manifest", &usda_manifest, py::arg("series"), doc("usda_manifest"));
  module.def(
      "write_usda_series",
      [](const Path& file, const std::vector<UsdFrame>& frames, const Bodies& bodies,
         const UsdOptions& options) { write_usda_series(file, frames, bodies, options); },
      py::arg("file"), py::arg("frames"), py::arg("bodies"),
      py::arg_v("options", UsdOptions{}, "UsdOptions()"), doc("write_usda_series"));
}

void bind_checkpoints(py::module_& module) {
  module.def("write_checkpoint", &write_checkpoint, py::arg("file"), py::arg("state"),
             doc("write_checkpoint"));
  module.def("read_checkpoint", &read_checkpoint, py::arg("file"), doc("read_checkpoint"));
  module.def("previous_checkpoint", &previous_checkpoint, py::arg("file"), doc("previous_checkpoint"));
  module.def("is_written_in_place", &is_written_in_place, py::arg("file"), doc("is_written_in_place"));
  module.def(
      "write_whole",
      [](const Path& file, const py::bytes& content) { write_whole(file, std::string_view(content)); },
      py::arg("file"), py::arg("content"), doc("write_whole#2"));
  module.def("write_whole",
             py::overload_cast<const Path&, const std::function<void(const Path&)>&>(&write_whole),
             py::arg("file"), py::arg("write"), doc("write_whole"));
}

}  // namespace

void bind_files(py::module_& module) {
  bind_choices(module);
  bind_structs(module);
  bind_particles(module);
  bind_mesh_files(module);
  bind_series(module);
  bind_checkpoints(module);
}

}  // namespace mallow::python
