#pragma once

#include "core/rules/shapes.hpp"

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

/// The regions below a TerrainScatter3D, as they stood when last read, and the sets of shapes that they make for its layers.
/// Main thread only.
class RegionRegister {
public:
	/// A region counts from `add` to `remove`.
	void add(ScatterRegion3D *region);
	void remove(ScatterRegion3D *region);

	/// The region has to be read again. One that is not in the register is ignored.
	void mark(const ScatterRegion3D *region);

	/// True if the path that a region follows has changed. Ask in every frame: a path does not tell.
	bool paths_changed();

	/// All regions have to be read again. False if there are none.
	bool mark_all();

	/// Reads the regions that were marked. After the scene was `recentered`, a region counts as unmoved if it stands in the
	/// world where it stood, to within what single precision makes of that.
	void update(bool recentered);

	/// The shapes that count for the layer at this index of the node's list; null for none. The same pointer as last time
	/// while nothing has changed.
	std::shared_ptr<const ShapeSet> set_for(const godot::TypedArray<ScatterLayer> &p_layers, std::size_t index);

	/// The names of the regions whose shapes these are, in the same order.
	std::vector<std::string> names_for(const godot::TypedArray<ScatterLayer> &p_layers, std::size_t index) const;

	/// A layer that was named `from` is now named `to`: regions that speak of it follow.
	void rename_layer(const godot::String &from, const godot::String &to) const;

	/// Has the editor ask all regions for their warnings again.
	void update_warnings() const;

private:
	struct Entry {
		ScatterRegion3D *node = nullptr;
		bool marked = true;
		std::optional<Shape> shape; ///< None while it has no effect.
		std::optional<Shape> read;  ///< As its node said last: the same, but for rounding.
		godot::Array layers;        ///< As the region names them.

		bool counts_for(const godot::TypedArray<ScatterLayer> &p_layers, std::size_t index) const;
	};

	std::vector<Entry> entries_;
	std::vector<std::shared_ptr<const ShapeSet>> sets_; ///< As last handed out, by the layer's index.
};

} // namespace thicket
