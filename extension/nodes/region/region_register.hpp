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

/// The regions below a TerrainScatter3D, as they were when last read, and the resulting sets of shapes for its layers.
/// Main thread only.
class RegionRegister {
public:
	/// A region has an effect from `add` to `remove`.
	void add(ScatterRegion3D *region);
	void remove(ScatterRegion3D *region);

	/// Marks a region to be reread. Ignores a region that is not in the register.
	void mark(const ScatterRegion3D *region);

	/// True if the path of any region has changed. Call it in every frame, because a path emits no signal.
	bool paths_changed();

	/// Marks all regions to be read again. False if there are none.
	bool mark_all();

	/// Rereads the marked regions. If the scene was `recentered`, a region has not moved if its world position is
	/// unchanged within single precision.
	void update(bool recentered);

	/// The shapes that affect the layer at this index of the node's list; null if there are none. Returns the same
	/// pointer as the last call if nothing has changed.
	std::shared_ptr<const ShapeSet> set_for(const godot::TypedArray<ScatterLayer> &p_layers, std::size_t index);

	/// The names of the regions that these shapes belong to, in the same order.
	std::vector<std::string> names_for(const godot::TypedArray<ScatterLayer> &p_layers, std::size_t index) const;

	/// Updates the references of all regions after a layer was renamed from `from` to `to`.
	void change_references(const ReferenceChange &change) const;

	/// Makes the editor query the warnings of all regions again.
	void update_warnings() const;

private:
	struct Entry {
		ScatterRegion3D *node = nullptr;
		bool marked = true;
		std::optional<Shape> shape; ///< Empty while it has no effect.
		std::optional<Shape> read;  ///< The last shape read from its node: the same, except for rounding.
		godot::Array layers;        ///< The region's references to layers.

		bool counts_for(const godot::TypedArray<ScatterLayer> &p_layers, std::size_t index) const;
	};

	std::vector<Entry> entries_;
	std::vector<std::shared_ptr<const ShapeSet>> sets_; ///< The sets that were last returned, by the layer's index.
};

} // namespace thicket
