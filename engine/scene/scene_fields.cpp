#include "scene/scene_fields.h"

#include <limits>

namespace mallow::scene_file {
namespace {

BoundFields joined(BoundFields first, const BoundFields& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

}  // namespace

const std::vector<std::string>& section_keys() {
  static const std::vector<std::string> keys{"solver",  "material", "body",    "collider", "pin",
                                             "emitter", "sink",     "surface", "run",      "render"};
  return keys;
}

BoundFields fields(SceneMaterial& material) {
  const BoundFields look{
      {"color", &material.color, between(0, 1), "", "red, green and blue in pictures, linear",
       "one of a palette"},
      {"finish", &material.finish, k_any, "",
       "in pictures: clear and cloudy, opaque and dull, soft, opaque and glossy, or clear"},
  };
  return joined({{"name", &material.name, k_any, "", "what bodies call it", k_required}},
                joined(fields(material.material), look));
}

SceneMaterial scene_material(const MaterialPreset& preset) {
  return {.name = preset.name,
          .material = preset.material,
          .color = preset.appearance.color,
          .finish = preset.appearance.finish};
}

BoundFields fields(SceneBody& body) {
  return {
      {"material", &body.material, k_any, "",
       "name of its [[material]], or of one that `mallow materials` lists", k_required},
      {"group", &body.group, k_any, "", "bodies of one group are one piece, with one reference shape",
       "a piece of its own"},
      {"merges", &body.merges, k_any, "",
       "acts on others of its material that merge as on itself: two puddles become one, and what flows once "
       "it is pressed together"},
      {"splits", &body.splits, k_any, "", "parts that it is torn into become bodies of their own, which touch"},
      {"velocity", &body.velocity, k_finite, "m/s", "of every particle at the start"},
      {"skin", &body.skin, k_any, "",
       "mesh that follows it and is drawn in place of its surface, OBJ, PLY, STL or OFF, placed as its own",
       "a surface around its particles"},
  };
}

BoundFields fields(SphereSource& source) {
  return joined({{"center", &source.center, k_finite, "m", "middle of the ball"},
                 {"radius", &source.radius, range_of(&Sphere::radius), "m", "of the ball", k_required}},
                fields(source.sampling));
}

BoundFields fields(MeshSource& source) {
  return joined({{"file", &source.file, k_any, "", "closed mesh, OBJ, PLY, STL or OFF, relative to the scene",
                  k_required}},
                joined(fields(source.sampling), fields(source.placement)));
}

BoundFields fields(PointsSource& source) {
  return {
      {"file", &source.file, k_any, "",
       "points x,y,z and optionally vx,vy,vz, PLY or CSV with a header, relative to the scene", k_required},
      {"spacing", &source.spacing, range_of(&Sampling::spacing), "m", "distance of neighbouring particles, h",
       k_required},
  };
}

BoundFields fields(ImplicitSource& source) {
  return joined({{"shape", &source.shape, k_any, "", "name of a built-in shape: moai", k_required}},
                joined(fields(source.sampling), fields(source.placement)));
}

BoundFields fields(SceneCollider& collider) {
  const BoundFields pose{
      {"translate", &collider.translate, k_finite, "m", "where the origin of its shape is at the start"},
      {"rotate", &collider.rotate, k_finite, "degrees", "turn of its shape about x, then y, then z"},
  };
  const BoundFields look{
      {"visible", &collider.visible, k_any, "", "it is seen in pictures; false: it acts all the same"},
  };
  return joined(pose, joined(fields(static_cast<Collider&>(collider)), look));
}

BoundFields fields(ScenePaint& paint) {
  return {
      {"translate", &paint.translate, k_finite, "m", "where the origin of its shape is"},
      {"rotate", &paint.rotate, k_finite, "degrees", "turn of its shape about x, then y, then z"},
      {"alpha", &paint.alpha, range_of(&Material::alpha), "", "of the particles in it, for the whole run",
       "the material's"},
      {"stiffness", &paint.stiffness, k_stiffness_factor, "", "factor on the elastic modulus in it", "1"},
      {"plastic_yield", &paint.plastic_yield, range_of(&Material::plastic_yield), "",
       "strain beyond which matter in it flows", "the material's"},
      {"temperature", &paint.paint_temperature, range_of(&Material::temperature), "K",
       "of the particles in it at the start", "the material's"},
  };
}

BoundFields fields(HullSource& source) {
  return {
      {"file", &source.file, k_any, "",
       "mesh whose corners are the points, OBJ, PLY, STL or OFF, relative to the scene; this or points",
       "points"},
      {"points", &source.points, k_finite, "m", "that the hull holds, 4 or more", "those of file"},
      {"inside", &source.inside, k_any, "", "particles are kept in, not out"},
  };
}

BoundFields fields(MeshColliderSource& source) {
  return {
      {"file", &source.file, k_any, "", "closed mesh, OBJ, PLY, STL or OFF, relative to the scene",
       k_required},
      {"voxels", &source.voxels, k_collider_voxels, "",
       "along its longest side; thinner parts may be missed"},
      {"size", &source.size, range_of(&Placement::size), "m", "longest side", "as in the file"},
      {"center", &source.center, k_finite, "m", "middle of its box", "where the file has it"},
      {"inside", &source.inside, k_any, "", "particles are kept in, not out"},
  };
}

BoundFields fields(SceneKeyframe& keyframe) {
  return {
      {"time", &keyframe.time, k_finite, "s", "when it is there, after the keyframe before", k_required},
      {"translate", &keyframe.translate, k_finite, "m", "where its origin is then"},
      {"rotate", &keyframe.rotate, k_finite, "degrees",
       "its turn about x, then y, then z; from one to the next the shorter way round"},
  };
}

BoundFields fields(ScenePin& pin) {
  return {{"velocity", &pin.velocity, k_finite, "m/s",
           "of the particles that are in the box at the start, for the whole run"}};
}

BoundFields fields(SceneEmitter& emitter) {
  const BoundFields place{
      {"material", &emitter.material, k_any, "",
       "name of its [[material]], or of one that `mallow materials` lists", k_required},
      {"translate", &emitter.translate, k_finite, "m", "where the nozzle is at the start"},
      {"rotate", &emitter.rotate, k_finite, "degrees",
       "turn of the nozzle about x, then y, then z; unturned the strand leaves it upwards, along z"},
  };
  const BoundFields section{
      {"points", &emitter.points, k_finite, "m",
       "of a layer, along x and y of the nozzle, z left out; in place of radius, width and height",
       "from radius, or width and height"},
  };
  return joined(place, joined(fields(static_cast<Emitter&>(emitter)), section));
}

BoundFields fields(SceneSink& sink) {
  return {{"outside", &sink.outside, k_any, "", "it takes what leaves the box, not what comes into it"}};
}

BoundFields fields(Aabb& box) {
  return {
      {"min", &box.min, k_finite, "m", "lowest corner", k_required},
      {"max", &box.max, k_finite, "m", "highest corner", k_required},
  };
}

BoundFields fields(RenderConfig& render) {
  BoundFields all = fields<RenderConfig>(render);
  all.push_back({"environment", &render.environment, k_any, "",
                 "Radiance picture (.hdr) of all around to light by, z up, relative to the scene",
                 "a studio"});
  return all;
}

const std::vector<Kind<BodySource>>& source_kinds() {
  static const std::vector<Kind<BodySource>> kinds{{"box", Lattice{}},
                                                   {"sphere", SphereSource{}},
                                                   {"mesh", MeshSource{}},
                                                   {"points", PointsSource{}},
                                                   {"implicit", ImplicitSource{}}};
  return kinds;
}

const std::vector<Kind<SceneShape>>& primitive_kinds() {
  static const std::vector<Kind<SceneShape>> kinds = []<class... Shapes>(const std::variant<Shapes...>&) {
    return std::vector<Kind<SceneShape>>{{ShapeTraits<Shapes>::k_key, typename InScenes<Shapes>::Type{}}...};
  }(Primitive{});
  return kinds;
}

}  // namespace mallow::scene_file
