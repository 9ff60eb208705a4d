#pragma once

#include "core/base/rect.hpp"
#include "core/terrain/terrain.hpp"
#include "nodes/ground/call_gate.hpp"
#include "nodes/ground/post_grid_area.hpp"
#include "nodes/ground/terrain_map.hpp"

#include <godot_cpp/variant/string_name.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <atomic>
#include <memory>
#include <optional>

namespace thicket {

/// Limits for objects whose methods return a height even at positions without ground.
struct GroundLimits {
	/// The area that has ground, in world x and z; empty for no limit. Half-open, like
	/// Rect2.has_point.
	Rect bounds;
	std::optional<float> no_ground; ///< A height that means "no ground".
};

/// Ground from the methods of a Godot object of any class, either:
/// - `get_height(Vector3)` and optionally `get_normal(Vector3)`, of the object itself or of its
///   property `data`, in global space, with NAN where there is no ground (Terrain3D:
///   `data.get_height`), or
/// - `get_data().get_interpolated_height_at(Vector3)` in map space, with
///   `get_data().get_resolution()` and the object's `get_internal_transform()` (HTerrain; see
///   TerrainMap for its holes and textures), or
/// - the methods of MTerrain; see PostGridArea.
///
/// In the first case, texture weights come from the optional method `get_texture_id(Vector3)`. It
/// must return the base texture, the overlay texture, and the weight of the overlay from 0 to 1.
class ObjectGround : public Terrain {
public:
	/// Creates the ground of an object. Returns null if the object has none of these methods. May
	/// run scripts of the object, which may free it.
	static std::shared_ptr<ObjectGround> of(const godot::Variant &p_object, const GroundLimits &limits);

	/// Creates a copy for a world in which the engine's origin is at `offset`, in meters. Each host
	/// needs its own copy, because the object is in the engine's space.
	std::shared_ptr<ObjectGround> at_offset(glm::dvec3 offset) const;

	/// Updates the offset after the scene was recentered. Waits for other threads like `close`. Has
	/// no effect on a map, which keeps the offset at which it was found.
	void set_offset(glm::dvec3 offset);

	std::uint64_t version() const override { return 0; }

	/// Samples the ground; see Terrain::sample. Any thread may call this method if the object's
	/// methods are thread-safe. If one of them fails or returns a value of the wrong type, returns
	/// an error that names it.
	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override;
	Status sample_heights(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override;
	Status weigh(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
			std::span<Ground> r_ground) const override;

	/// Returns false if the height at a position is unknown, because an MTerrain has not loaded its
	/// ground there or is closed. `sample` then returns no ground.
	bool is_height_known(glm::dvec2 position) const;

	/// Returns true if the methods must be called on the main thread, regardless of
	/// ScatterGroundNode.thread_safe. This is true for MTerrain, which frees the heights of regions
	/// on its own threads.
	bool needs_main_thread() const { return posts_ != nullptr; }

	/// Makes later calls fail, and waits until other threads have finished their current calls, at
	/// most a few dozen positions each. Call this before the object is freed. If a method of the
	/// object causes this call, it does not wait for the calling thread.
	void close();
	bool is_open() const { return is_open_; }

	/// Returns false if the ground has no textures, so that `weigh` has no effect.
	bool has_textures() const { return map_ != nullptr ? !map_->splats.empty() : has_textures_; }

	/// Returns the object whose methods are called: the original object or its data. Returns null
	/// once that object is freed.
	godot::Object *source() const { return source_.get_validated_object(); }
	/// Returns the map of an HTerrain-like object; null for other objects.
	const TerrainMap *map() const { return map_.get(); }

private:
	bool take_methods(const godot::Variant &p_object);
	bool take_map(const godot::Variant &p_object);
	void take_post_grid();
	Status sample_all(std::span<const glm::dvec2> positions, bool with_normals, std::span<Ground> r_ground) const;
	Status sample_slice(std::span<const glm::dvec2> positions, bool with_normals, std::span<Ground> r_ground) const;
	Status ground_at(glm::dvec2 position, bool with_normal, Ground &r_ground) const;
	glm::dvec2 in_engine(glm::dvec2 position) const { return position - glm::dvec2(offset_.x, offset_.z); }
	bool within_bounds(glm::dvec2 position) const;
	Status height_at(glm::dvec2 position, float &r_height) const;
	Status slope_by_heights(glm::dvec2 position, Ground &r_ground) const;
	Status normal_at(glm::dvec2 position, Ground &r_ground) const;
	Status weigh_by_textures(glm::dvec2 position, std::span<const std::int32_t> textures, Ground &r_ground) const;
	Status call(const godot::StringName &p_method, const char *p_property, glm::dvec2 position,
			godot::Variant &r_result) const;

	godot::Variant source_;
	godot::StringName height_method_ = "get_height";
	godot::StringName normal_method_ = "get_normal";
	godot::StringName texture_method_ = "get_texture_id";
	bool has_normal_ = false;
	bool has_textures_ = false;
	std::shared_ptr<const TerrainMap> map_;
	std::shared_ptr<const PostGridArea> posts_; ///< Null unless the object has the methods of MTerrain.
	GroundLimits limits_;
	/// The world position of the engine's origin, guarded by gate_. The offset of a map never
	/// changes.
	glm::dvec3 offset_{0.0};

	/// Methods are called inside this gate, so that the object is not freed during a call.
	CallGate gate_;
	std::atomic<bool> is_open_ = true;
};

} // namespace thicket
