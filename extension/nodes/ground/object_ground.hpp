#pragma once

#include "core/base/rect.hpp"
#include "core/terrain/terrain.hpp"
#include "nodes/ground/call_gate.hpp"
#include "nodes/ground/terrain_map.hpp"

#include <godot_cpp/variant/string_name.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <atomic>
#include <memory>
#include <optional>

namespace thicket {

/// The area in which an object's methods know the ground, for methods that return a height everywhere.
struct GroundLimits {
	Rect bounds;                    ///< World meters of x and z; empty for no limit. Half-open, as Rect2.has_point.
	std::optional<float> no_ground; ///< The height that means no ground.
};

/// Ground from the methods of an object of the engine, whatever its class:
/// - `get_height(Vector3)` and maybe `get_normal(Vector3)`, of the object itself or of its property `data`, in world
///   space, NAN where there is no ground (Terrain3D: `data.get_height`);
/// - `get_data().get_interpolated_height_at(Vector3)` in the map's own space, with `get_data().get_resolution()` and
///   `get_internal_transform()` of the object itself (HTerrain; see TerrainMap for its holes and textures).
/// An object with `get_texture_id(Vector3)`, which returns a base texture, an overlay and the share of the overlay from 0 to 1, also has
/// weights.
class ObjectGround : public Terrain {
public:
	/// Creates the ground of an object; null if the object has none of these methods. Checking for them may run scripts
	/// of the object, which may free it.
	static std::shared_ptr<ObjectGround> of(const godot::Variant &p_object, const GroundLimits &limits);

	/// A copy of the ground for a world in which the engine's origin is at `offset`, in meters, because the object is
	/// in the engine's space. Each node that uses the ground needs its own copy.
	std::shared_ptr<ObjectGround> at_offset(glm::dvec3 offset) const;

	/// Updates the offset after the scene was recentered. Waits as `close` does. A map keeps the offset at which it was found.
	void set_offset(glm::dvec3 offset);

	/// Samples as Terrain::sample does, on any thread if the object's methods allow that. If a method is missing or
	/// does not return a number, the error names it.
	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override;
	Status sample_heights(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override;
	Status weigh(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
			std::span<Ground> r_ground) const override;

	/// Call this before the object is freed. Waits until other threads have finished their calls, a few dozen positions
	/// at most. Refuses all later calls. A script may call this from within such a call, and does not wait for itself.
	void close();
	bool is_open() const { return open_; }

	/// False if `weigh` leaves all weights unchanged, or 1.
	bool has_textures() const { return map_ != nullptr ? !map_->splats.empty() : has_textures_; }

	/// The object that has the methods: the object itself or its data. Null if it has been freed.
	godot::Object *source() const { return source_.get_validated_object(); }
	/// Null for an object that has none.
	const TerrainMap *map() const { return map_.get(); }

private:
	bool take_methods(const godot::Variant &p_object);
	bool take_map(const godot::Variant &p_object);
	Status sample_all(std::span<const glm::dvec2> positions, bool normals, std::span<Ground> r_ground) const;
	Status sample_slice(std::span<const glm::dvec2> positions, bool normals, std::span<Ground> r_ground) const;
	Status ground_at(glm::dvec2 position, bool normal, Ground &r_ground) const;
	glm::dvec2 in_engine(glm::dvec2 position) const { return position - glm::dvec2(offset_.x, offset_.z); }
	bool within_bounds(glm::dvec2 position) const;
	Status height_at(glm::dvec2 position, float &r_height) const;
	Status slope_by_heights(glm::dvec2 position, Ground &r_ground) const;
	Status normal_at(glm::dvec2 position, Ground &r_ground) const;
	Status weigh_by_textures(glm::dvec2 position, std::span<const std::int32_t> textures, Ground &r_ground) const;
	Status call(const godot::StringName &p_method, const char *p_refusal, glm::dvec2 position,
			godot::Variant &r_result) const;

	godot::Variant source_;
	godot::StringName height_method_ = "get_height";
	godot::StringName normal_method_ = "get_normal";
	godot::StringName texture_method_ = "get_texture_id";
	bool has_normal_ = false;
	bool has_textures_ = false;
	std::shared_ptr<const TerrainMap> map_;
	GroundLimits limits_;
	glm::dvec3 offset_{0.0}; ///< Guarded by gate_; the offset of a map never changes.

	CallGate gate_; ///< Methods are called inside of it, so that the object is not freed in the meantime.
	std::atomic<bool> open_ = true;
};

} // namespace thicket
