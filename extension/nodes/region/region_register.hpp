#pragma once

#include "core/rules/shapes.hpp"
#include "nodes/layer/reference_change.hpp"

#include <godot_cpp/variant/array.hpp>
#include <godot_cpp/variant/string.hpp>
#include <godot_cpp/variant/typed_array.hpp>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace thicket {

class ScatterLayer;
class ScatterRegion3D;

/// Stores the regions that are descendants of a TerrainScatter3D, in the state in which they were
/// last read, and builds sets of shapes for the node's layers. Use it only on the main thread.
class RegionRegister {
public:
	/// Registers a region, which then affects layers until `remove`. Does not own the region.
	void add(ScatterRegion3D *region);
	void remove(ScatterRegion3D *region);

	/// Marks a region to be reread by `update`. Ignores regions that are not registered.
	void mark(const ScatterRegion3D *region);

	/// Marks the regions whose paths have changed since the last call, and returns true if there
	/// are any. Call this every frame, because a moved Path3D emits no signal.
	bool paths_changed();

	/// Marks all regions to be reread. Returns false if there are none.
	bool mark_all();

	/// Rereads the marked regions. If `was_recentered` is true, ignores changes of world
	/// positions that are due to rounding to single precision.
	void update(bool was_recentered);

	/// Returns the shapes that affect the layer at this index of the node's list; null if there are
	/// none. The pointer stays the same until the shapes change.
	std::shared_ptr<const ShapeSet> set_for(const godot::TypedArray<ScatterLayer> &p_layers, std::size_t index);

	/// Returns the names of the regions that `set_for` takes shapes from, in the same order.
	std::vector<std::string> names_for(const godot::TypedArray<ScatterLayer> &p_layers, std::size_t index) const;

	/// Applies a change to references, for example after a layer was renamed, to all regions.
	void change_references(const ReferenceChange &change) const;

	/// Makes the editor update the configuration warnings of all regions.
	void update_warnings() const;

private:
	struct Entry {
		ScatterRegion3D *node = nullptr;
		bool is_marked = true;
		/// The shape for layers; empty while the region has no effect.
		std::optional<Shape> shape;
		/// The last shape read from the node. May differ from `shape` by rounding.
		std::optional<Shape> last_read;
		godot::Array layers; ///< The layers that the region affects; see ScatterRegion3D::get_layers.

		bool affects_layer(const godot::TypedArray<ScatterLayer> &p_layers, std::size_t index) const;
	};

	std::vector<Entry> entries_;
	std::vector<std::shared_ptr<const ShapeSet>> sets_; ///< The last returned sets, by layer index.
};

} // namespace thicket
