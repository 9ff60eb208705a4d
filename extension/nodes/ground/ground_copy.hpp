#pragma once

#include "core/terrain/terrain.hpp"

#include <godot_cpp/variant/rect2.hpp>
#include <godot_cpp/variant/rect2i.hpp>
#include <godot_cpp/variant/string.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <glm/vec3.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// The areas in which ground has changed, in the engine's space.
struct GroundChanges {
	bool everywhere = false;
	std::vector<godot::Rect2> areas; ///< Meters of x and z.

	bool empty() const { return !everywhere && areas.empty(); }
	void add(const GroundChanges &other);
};

/// An edited part of an image of a terrain.
struct MapEdit {
	std::int64_t map = 0;   ///< The plug-in's number for the kind of image.
	std::int64_t index = 0; ///< The image's index within its kind; below 0 for all.
	godot::Rect2i rect;     ///< Pixels.
};

/// A plug-in whose ground can be copied.
enum class GroundPlugin : std::uint8_t { none, terrain3d, hterrain };

/// The plug-in's name; empty for `none`.
const char *name_of(GroundPlugin plugin);

/// A copy of the ground of a known plug-in's node, so that workers do not call the node. Immutable. Shares its images
/// with the plug-in instead of copying them: whichever of the two writes to an image first creates its own copy.
class GroundCopy {
public:
	virtual ~GroundCopy() = default;
	GroundCopy(const GroundCopy &) = delete;
	GroundCopy &operator=(const GroundCopy &) = delete;

	virtual GroundPlugin plugin() const = 0;

	/// The ground in a world whose engine origin is at `offset`, in meters.
	virtual std::shared_ptr<const Terrain> at_offset(glm::dvec3 offset) const = 0;

	virtual bool has_textures() const = 0;

	/// A description of the copied ground, for the inspector.
	virtual godot::String description() const = 0;

	/// A remark about the node for users: the end of a sentence that begins with the node's name ("has no regions").
	/// Empty if there is none.
	virtual godot::String remark() const = 0;

	/// The areas in which this ground differs from `before`. `shift` is the distance that the engine's origin has moved
	/// in the world since then.
	virtual GroundChanges changes_since(const GroundCopy &before, glm::dvec3 shift) const = 0;

	/// A new copy, with some parts reread from the node's data. Null if rereading these parts fails or is not enough.
	/// Runs scripts.
	virtual std::shared_ptr<const GroundCopy> with_edits(
			const godot::Variant & /*p_data*/, std::span<const MapEdit> /*edits*/) const {
		return nullptr;
	}

protected:
	GroundCopy() = default;
};

/// The result of trying to copy a node's ground.
struct CopyAttempt {
	GroundPlugin plugin = GroundPlugin::none; ///< The plug-in that the node belongs to.
	std::shared_ptr<const GroundCopy> copy;   ///< Null if it was refused; then `refusal` has the reason.
	godot::String refusal;                    ///< As the end of a sentence that begins with the node.
	godot::Variant data;                      ///< The object that holds the plug-in's images and emits its signals.
};

/// Copies the ground of a node that has the methods of Terrain3D or HTerrain, whatever its class. Does not reread parts
/// that are unchanged since the copy `before`. Runs scripts, which may free the node.
CopyAttempt copy_ground(const godot::Variant &p_node, const GroundCopy *before);
CopyAttempt copy_terrain3d(const godot::Variant &p_node);
CopyAttempt copy_hterrain(const godot::Variant &p_node, const GroundCopy *before);

/// True if a node with HTerrain's methods paints textures by index (its array shader) rather than by splat maps. Runs
/// scripts.
bool uses_indexed_textures(const godot::Variant &p_node);

/// Values that are cheap to read, and that differ if a node's ground may have changed since the last check.
struct GroundGlance {
	std::uint64_t node = 0;
	std::uint64_t data = 0; ///< The object that holds its ground, if that is a separate object.
	double spacing = 0.0;
	bool indexed = false; ///< HTerrain: textures are by index.

	bool operator==(const GroundGlance &) const = default;
};

/// If `deep` is true, also calls the node, which may run scripts. Otherwise only checks whether it is the same node.
GroundGlance glance_at(const godot::Variant &p_node, bool deep);

} // namespace thicket
