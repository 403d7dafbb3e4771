#pragma once

#include <string>
#include <vector>

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
/// The keyframes of a collider, where it has any.
void read_keyframes(const Node& table, const std::string& path, SceneCollider& collider, Problems& problems);

/// Reads fields and says whether nothing was wrong with them, so that checks of one against another make
/// sense.
bool read_whole(const Node& table, const std::string& path, const BoundFields& fields,
                const std::vector<std::string>& also, Problems& problems);
/// A box of which each side may be empty, but not negative.
void check_box(const Aabb& box, const Node& table, const std::string& path, Problems& problems);

}  // namespace mallow::scene_file
