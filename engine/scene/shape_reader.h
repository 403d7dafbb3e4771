#pragma once

#include <string>
#include <vector>

#include "colliders/pose.h"
#include "scene/document.h"
#include "scene/scene_fields.h"
#include "scene/scene_files.h"

/// The parts of bodies and colliders that say what shape they have: one key of several, with a table of its
/// own.
namespace mallow::scene_file {

const std::vector<std::string>& source_keys();  ///< of a body
const std::vector<std::string>& shape_keys();   ///< of a collider

/// body: the table of a [[body]]; files: those that it may name.
void read_source(const Node& body, const std::string& path, const SceneFiles& files, BodySource& source,
                 Problems& problems);
/// Checks the file that a key of a table names, where it names one.
void check_file(const Node& table, const std::string& path, const char* key, const SceneFiles& files,
                const std::filesystem::path& name, Problems& problems);
/// table: that of a [[collider]]; files: those that it may name, of which its shape is made.
void read_shape(const Node& table, const std::string& path, const SceneFiles& files, SceneCollider& collider,
                Problems& problems);
/// Those of a collider or an emitter, none where the table has none.
std::vector<SceneKeyframe> read_keyframes(const Node& table, const std::string& path, Problems& problems);
/// The pose of a collider or an emitter as the scene begins, and its keyframes where it has any.
template <class Posed>
void read_pose(const Node& table, const std::string& path, Posed& posed, Problems& problems) {
  posed.pose = pose_of(posed.translate, posed.rotate);
  posed.scene_keyframes = read_keyframes(table, path, problems);
  for (const SceneKeyframe& key : posed.scene_keyframes)
    posed.keyframes.push_back({static_cast<double>(key.time), pose_of(key.translate, key.rotate)});
  if (!posed.keyframes.empty()) posed.pose = pose_at(posed.keyframes, 0);
}

/// Reads fields and says whether nothing was wrong with them, so that checks of one against another make
/// sense.
bool read_whole(const Node& table, const std::string& path, const BoundFields& fields,
                const std::vector<std::string>& also, Problems& problems);
/// A box of which each side may be empty, but not negative.
void check_box(const Aabb& box, const Node& table, const std::string& path, Problems& problems);

}  // namespace mallow::scene_file
