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

/// The areas in which a ground has changed, in the engine's space.
struct GroundChanges {
	bool whole_ground = false;       ///< True if any position may have changed.
	std::vector<godot::Rect2> areas; ///< The changed areas in the engine's x and z, in meters.

	bool empty() const { return !whole_ground && areas.empty(); }
	void add(const GroundChanges &other);
};

/// An edit to part of a terrain's image.
struct MapEdit {
	std::int64_t map = 0;   ///< The plugin's ID of this kind of image.
	std::int64_t index = 0; ///< The image's index within its kind; negative for all images of the kind.
	godot::Rect2i rect;     ///< The edited part of the image in pixels.
};

/// The terrain plugins whose ground can be copied.
enum class GroundPlugin : std::uint8_t { none, terrain3d, hterrain, terrabrush };

/// Returns the plugin's name for messages; empty for `none`.
const char *name_of(GroundPlugin plugin);

/// An immutable copy of the ground of a plugin's node, so that workers need not call the node.
/// Shares the pixels of images with the plugin (copy-on-write).
class GroundCopy {
public:
	virtual ~GroundCopy() = default;
	GroundCopy(const GroundCopy &) = delete;
	GroundCopy &operator=(const GroundCopy &) = delete;

	virtual GroundPlugin plugin() const = 0;

	/// Creates the ground for a world in which the engine's origin is at `offset`, in meters.
	virtual std::shared_ptr<const Terrain> at_offset(glm::dvec3 offset) const = 0;

	virtual bool has_textures() const = 0;

	/// Describes the copied ground for the inspector.
	virtual godot::String description() const = 0;

	/// Returns a remark for users. It completes a sentence that begins with the node's name, for
	/// example "has no regions". Returns an empty string if there is none.
	virtual godot::String remark() const = 0;

	/// Returns the areas in which this ground differs from `before`. `shift` is how far the
	/// engine's origin has moved in the world since then.
	virtual GroundChanges changes_since(const GroundCopy &before, glm::dvec3 shift) const = 0;

	/// Creates a new copy with only the edited parts reread from the node's data. Returns null if a
	/// full copy is necessary. Runs scripts.
	virtual std::shared_ptr<const GroundCopy> with_edits(
			const godot::Variant & /*p_data*/, std::span<const MapEdit> /*edits*/) const {
		return nullptr;
	}

	/// Returns true if the node's ground may differ from this copy even though no signal has
	/// reported a change. Called every frame. May run scripts.
	virtual bool is_outdated(const godot::Variant & /*p_node*/) const { return false; }

protected:
	GroundCopy() = default;
};

/// The result of trying to copy a node's ground.
struct CopyAttempt {
	GroundPlugin plugin = GroundPlugin::none; ///< The plugin that provides the node.
	std::shared_ptr<const GroundCopy> copy;   ///< The copied ground. Null if copying failed; see `refusal`.
	/// The reason for the failure. It completes a sentence that begins with the node's name.
	godot::String refusal;
	/// The object that contains the plugin's images and emits its signals.
	godot::Variant data;
};

/// Copies the ground of a node that has the methods of Terrain3D, HTerrain or TerraBrush,
/// regardless of its class. Reuses unchanged parts of the copy `before`, which may be null. Runs
/// scripts, which may free the node.
CopyAttempt copy_ground(const godot::Variant &p_node, const GroundCopy *before);
CopyAttempt copy_terrain3d(const godot::Variant &p_node, const GroundCopy *before);
CopyAttempt copy_terrabrush(const godot::Variant &p_node, const GroundCopy *before);
CopyAttempt copy_hterrain(const godot::Variant &p_node, const GroundCopy *before);

/// Returns true if an HTerrain node stores textures by index (its array shader) rather than in
/// splat maps. Runs scripts.
bool uses_indexed_textures(const godot::Variant &p_node);

/// Values that are cheap to read. If any of them differs, the node's ground may have changed.
struct GroundFingerprint {
	std::uint64_t node = 0;
	/// The ID of the object that contains the ground, if it is not the node itself.
	std::uint64_t data = 0;
	double spacing = 0.0;
	bool has_indexed_textures = false; ///< HTerrain: textures are stored by index.
	/// MTerrain: the area of the ground in the engine's x and z; empty if there is no ground yet.
	godot::Rect2 extent;

	bool operator==(const GroundFingerprint &) const = default;
};

/// Reads a GroundFingerprint. Unless `deep` is true, reads only the node's ID and runs no scripts.
GroundFingerprint fingerprint_of(const godot::Variant &p_node, bool deep);

} // namespace thicket
