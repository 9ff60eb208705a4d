#pragma once

#include "core/near/body_fit.hpp"
#include "core/query/instance_query.hpp"
#include "nodes/layer/scatter_layer.hpp"

#include <godot_cpp/variant/aabb.hpp>
#include <godot_cpp/variant/rid.hpp>

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

namespace thicket {

/// The data from which the collision shapes of a layer are created.
struct ShapeSource {
	ScatterLayer::CollisionShape kind = ScatterLayer::COLLISION_NONE;
	InstanceShape cylinder;
	/// The meshes for convex shapes. A null mesh has no shape.
	std::vector<godot::Ref<godot::Mesh>> meshes;
	/// The bounding box of each mesh. If the box differs, the mesh has changed.
	std::vector<godot::AABB> boxes;
	/// The body parts of each mesh's model, if the models provide the shapes.
	std::vector<std::vector<BodyPart>> parts;

	friend bool operator==(const ShapeSource &a, const ShapeSource &b) {
		return a.kind == b.kind && a.cylinder.radius == b.cylinder.radius && a.cylinder.height == b.cylinder.height &&
				a.meshes == b.meshes && a.boxes == b.boxes && a.parts == b.parts;
	}
};

/// A cache of PhysicsServer3D shapes. Instances of nearly the same size share a shape (see
/// BodyFit). Some unused shapes are kept for reuse. Use it only on the main thread.
class CollisionShapes {
public:
	/// The kind, Corners::id (0 for shapes without corners), and three sizes in meters. For
	/// convex shapes, the sizes are the scale of the corners.
	using Key = std::tuple<BodyPart::Kind, std::uint64_t, float, float, float>;

	/// A shape, and the number of bodies that use it. The address of the shape is stable while it
	/// has users.
	struct Shape {
		godot::RID rid;
		std::size_t users = 0;
		const Key *key = nullptr;
		bool is_listed = false; ///< True if the shape is in `idle_list_`, even if it has users again.
	};

	/// A shape and its transform in a body. The body's axes are the instance's axes without their
	/// scale.
	struct PlacedShape {
		Shape *shape = nullptr;
		glm::mat3 rotation{1.0f};
		glm::vec3 origin{0.0f}; ///< The position of the shape in the body, in meters.
	};

	CollisionShapes() = default;
	CollisionShapes(const CollisionShapes &) = delete;
	CollisionShapes &operator=(const CollisionShapes &) = delete;
	~CollisionShapes() { clear(); }

	/// Returns the shapes of an instance and increments their user counts. The result is empty if
	/// there is nothing to collide with. Pass it to `give_back` when the body is removed.
	std::vector<PlacedShape> take(const ShapeSource &source, std::uint32_t mesh_index, const BodyFit &fit);
	void give_back(const std::vector<PlacedShape> &shapes);

	/// Frees a few unused shapes if there are more than `max_idle`. Returns false if there is
	/// nothing to free.
	bool free_some();

	/// Frees all shapes, none of which may be in use.
	void clear();

	/// The maximum number of unused shapes to keep.
	static constexpr std::size_t max_idle = 256;
	/// The maximum number of shapes that one call to `free_some` frees.
	static constexpr int max_freed_per_call = 16;

private:
	/// The corners of a mesh's convex hull at scale 1.
	struct Corners {
		godot::AABB box;      ///< The mesh's bounding box when the corners were read.
		std::uint64_t id = 0; ///< Identifies the corners in keys; 0 before they are read.
		std::vector<glm::vec3> points;
	};

	static Shape make(const Key &key, const std::vector<glm::vec3> &corners);
	const Corners *corners_of(const ShapeSource &source, std::uint32_t mesh_index);
	const Corners *corners_of(const BodyPart &part);
	static const Corners *usable_corners(const Corners &corners);
	Shape *take(const Key &key, const std::vector<glm::vec3> &corners);
	void add_part(const BodyPart &part, const BodyFit &fit, std::vector<PlacedShape> &r_shapes);

	std::map<Key, Shape> shapes_;
	/// Shapes without users, in the order in which they lost their last user. May also contain
	/// shapes that have users again.
	std::deque<Shape *> idle_list_;
	std::map<std::uint64_t, Corners> corners_; ///< The corners of each mesh, keyed by its object ID.
	/// The corners of convex body parts of models.
	std::vector<std::pair<BodyPart, Corners>> part_corners_;
	std::uint64_t last_corners_id_ = 0;
	std::size_t idle_count_ = 0;
};

} // namespace thicket
