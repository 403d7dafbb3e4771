#pragma once

#include <memory>
#include <utility>

#include "mallow/mesh.h"
#include "simulation.h"

namespace mallow::python {

/// The columns of a mesh: its own, or those that a Surfacer or Skin drew last, which `keeper` keeps until
/// they are taken over. Arrays show them where they lie and keep the cell.
struct MeshCell {
  Mesh own;
  const Mesh* seen = &own;
  std::shared_ptr<const void> keeper;

  /// Before what drew the mesh draws again. Vectors keep their memory where they are swapped, so that arrays
  /// go on to show this mesh, whose columns are now its own; what drew it goes on with a copy.
  void take_over() {
    if (seen == &own) return;
    auto& drawn = const_cast<Mesh&>(*seen);  // a member of what drew it, which is not const
    own = drawn;
    std::swap(own, drawn);
    seen = &own;
    keeper.reset();
  }
};

/// A mesh as Python holds it. Columns are given whole; a new one goes into a new cell, and arrays of the old
/// one show what they showed.
class MeshObject {
 public:
  MeshObject() : cell_(std::make_shared<MeshCell>()) {}
  MeshObject(Mesh mesh) : MeshObject() { cell_->own = std::move(mesh); }  // NOLINT: a mesh
  explicit MeshObject(std::shared_ptr<MeshCell> cell) : cell_(std::move(cell)) {}

  const Mesh& mesh() const { return *cell_->seen; }
  const std::shared_ptr<MeshCell>& cell() const { return cell_; }
  template <class Column>
  void set(Column Mesh::*column, Column values) {
    auto cell = std::make_shared<MeshCell>();
    cell->own = mesh();
    cell->own.*column = std::move(values);
    cell_ = std::move(cell);
  }
  /// A copy that the engine may read without looking: throws ConfigError where an index is none, or columns
  /// differ in length.
  Mesh checked() const;

 private:
  std::shared_ptr<MeshCell> cell_;
};

/// Hands out meshes that stay valid: what draws them over and over calls free() before it does.
class DrawnMesh {
 public:
  MeshObject show(const Mesh& mesh, std::shared_ptr<const void> keeper) {
    std::shared_ptr<MeshCell> cell = last_.lock();
    if (!cell || cell->seen != &mesh) {
      free();
      cell = std::make_shared<MeshCell>();
      cell->seen = &mesh;
      cell->keeper = std::move(keeper);
      last_ = cell;
    }
    return MeshObject(cell);
  }
  void free() {
    if (const std::shared_ptr<MeshCell> cell = last_.lock()) cell->take_over();
    last_.reset();
  }

 private:
  std::weak_ptr<MeshCell> last_;
};

}  // namespace mallow::python
