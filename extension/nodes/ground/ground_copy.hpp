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

/// Where ground is another one than it was, in the engine's space.
struct GroundChanges {
	bool everywhere = false;
	std::vector<godot::Rect2> areas; ///< Meters of x and z.

	bool empty() const { return !everywhere && areas.empty(); }
	void add(const GroundChanges &other);
};

/// A part of an image of a terrain that was edited.
struct MapEdit {
	std::int64_t map = 0;   ///< The plug-in's number of the kind of image.
	std::int64_t index = 0; ///< Which one of that kind; below 0 for all.
	godot::Rect2i rect;     ///< Pixels.
};

/// A plug-in whose ground can be copied.
enum class GroundPlugin : std::uint8_t { none, terrain3d, hterrain };

/// Its name; empty for none.
const char *name_of(GroundPlugin plugin);

/// The ground that a node of a known plug-in holds, copied, so that workers ask nothing of the node. Immutable. Images are
/// not copied but shared with the plug-in: whichever of both writes to one makes a copy of its own first.
class GroundCopy {
public:
	virtual ~GroundCopy() = default;
	GroundCopy(const GroundCopy &) = delete;
	GroundCopy &operator=(const GroundCopy &) = delete;

	virtual GroundPlugin plugin() const = 0;

	/// The ground where the engine's origin is at `offset` in the world, in meters.
	virtual std::shared_ptr<const Terrain> at_offset(glm::dvec3 offset) const = 0;

	virtual bool has_textures() const = 0;

	/// What it is a copy of, for the inspector.
	virtual godot::String description() const = 0;

	/// What a user should know about the node, as an end of a sentence that begins with it ("has no regions"); empty for nothing.
	virtual godot::String remark() const = 0;

	/// Where this is another ground than `before`. `shift` is how far the engine's origin has moved in the world since.
	virtual GroundChanges changes_since(const GroundCopy &before, glm::dvec3 shift) const = 0;

	/// This copy with some parts read again from the node's data; null where that does not suffice or fails. Runs scripts.
	virtual std::shared_ptr<const GroundCopy> with_edits(
			const godot::Variant & /*p_data*/, std::span<const MapEdit> /*edits*/) const {
		return nullptr;
	}

protected:
	GroundCopy() = default;
};

/// What came of trying to copy a node's ground.
struct CopyAttempt {
	GroundPlugin plugin = GroundPlugin::none; ///< Which one the node is like.
	std::shared_ptr<const GroundCopy> copy;   ///< Null where `refusal` says why.
	godot::String refusal;                    ///< As an end of a sentence that begins with the node.
	godot::Variant data;                      ///< What holds the plug-in's images and emits its signals.
};

/// Copies the ground of a node that behaves as one of Terrain3D or HTerrain does, whatever its class. What a copy `before` has
/// read and is still the same need not be read again. Runs scripts, which may free the node.
CopyAttempt copy_ground(const godot::Variant &p_node, const GroundCopy *before);
CopyAttempt copy_terrain3d(const godot::Variant &p_node);
CopyAttempt copy_hterrain(const godot::Variant &p_node, const GroundCopy *before);

/// Whether a node like HTerrain paints with textures by index (its array shader) rather than by splat maps. Runs scripts.
bool uses_indexed_textures(const godot::Variant &p_node);

/// What tells without much ado that a node may have other ground than when it was looked at last.
struct GroundGlance {
	std::uint64_t node = 0;
	std::uint64_t data = 0; ///< What holds its ground, if that is an object of its own.
	double spacing = 0.0;
	bool indexed = false; ///< HTerrain: textures are by index.

	bool operator==(const GroundGlance &) const = default;
};

/// `deep`: also asks the node, which may run scripts; otherwise only whether it is the same.
GroundGlance glance_at(const godot::Variant &p_node, bool deep);

} // namespace thicket
