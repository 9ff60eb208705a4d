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

/// The data that the shapes of a layer are created from.
struct ShapeSource {
	ScatterLayer::CollisionShape kind = ScatterLayer::COLLISION_NONE;
	InstanceShape cylinder;
	std::vector<godot::Ref<godot::Mesh>> meshes; ///< For convex shapes only; null entries have none.
	std::vector<godot::AABB> boxes;              ///< One for each mesh; a different box means a changed mesh.
	std::vector<std::vector<BodyPart>> parts;    ///< Those of the meshes' models, if the models provide the shapes.

	friend bool operator==(const ShapeSource &a, const ShapeSource &b) {
		return a.kind == b.kind && a.cylinder.radius == b.cylinder.radius && a.cylinder.height == b.cylinder.height &&
				a.meshes == b.meshes && a.boxes == b.boxes && a.parts == b.parts;
	}
};

/// Shapes of the PhysicsServer3D, shared by all instances of nearly the same size (see BodyFit). Unused shapes are kept for a while. Main
/// thread only.
class CollisionShapes {
public:
	/// The kind, Corners::number (0 if there are none), and three sizes: in meters, or the scale of the corners.
	using Key = std::tuple<BodyPart::Kind, std::uint64_t, float, float, float>;

	/// Keeps its address as long as it has users.
	struct Shape {
		godot::RID rid;
		std::size_t users = 0;
		const Key *key = nullptr;
		bool listed = false; ///< True if it is in the list of idle shapes; it may have users again.
	};

	/// A shape with its transform in a body. The axes of the body are those of the instance, without its scale.
	struct Placed {
		Shape *shape = nullptr;
		glm::mat3 rotation{1.0f};
		glm::vec3 origin{0.0f}; ///< Meters.
	};

	CollisionShapes() = default;
	CollisionShapes(const CollisionShapes &) = delete;
	CollisionShapes &operator=(const CollisionShapes &) = delete;
	~CollisionShapes() { clear(); }

	/// Returns the shapes of an instance and counts them as used. Empty if there is nothing to collide with.
	std::vector<Placed> take(const ShapeSource &source, std::uint32_t mesh, const BodyFit &fit);
	void give_back(const std::vector<Placed> &shapes);

	/// Frees a few unused shapes while more than `max_idle` are unused. Returns false if nothing can be freed.
	bool free_some();

	/// Frees all shapes; none may be in use any more.
	void clear();

	/// The largest number of unused shapes to keep.
	static constexpr std::size_t max_idle = 256;
	/// The number of further shapes that one call of `free_some` frees.
	static constexpr int freed_at_once = 16;

private:
	/// The corners of a mesh's convex hull at scale 1.
	struct Corners {
		godot::AABB box; ///< The box of the mesh when they were read.
		std::uint64_t number = 0;
		std::vector<glm::vec3> points;
	};

	static Shape make(const Key &key, const std::vector<glm::vec3> &corners);
	const Corners *corners_of(const ShapeSource &source, std::uint32_t mesh);
	const Corners *corners_of(const BodyPart &part);
	static const Corners *usable(const Corners &corners);
	Shape *take(const Key &key, const std::vector<glm::vec3> &corners);
	void add_part(const BodyPart &part, const BodyFit &fit, std::vector<Placed> &r_shapes);

	std::map<Key, Shape> shapes_;
	std::deque<Shape *> idle_list_; ///< Shapes without users, the longest idle first, and some that have users again.
	std::map<std::uint64_t, Corners> corners_;               ///< By the mesh's object ID.
	std::vector<std::pair<BodyPart, Corners>> part_corners_; ///< For convex parts of models.
	std::uint64_t last_number_ = 0;
	std::size_t idle_ = 0;
};

} // namespace thicket
