#pragma once

#include "core/rules/shapes.hpp"

#include <godot_cpp/variant/packed_string_array.hpp>

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace thicket {

class ScatterShape3D;

/// The shapes below a TerrainScatter3D, as they stood when last looked at, and the sets that they make for its layers.
/// Main thread only.
class ShapeRegister {
public:
	/// A shape counts from `add` to `remove`.
	void add(ScatterShape3D *shape);
	void remove(ScatterShape3D *shape);

	/// The shape has to be looked at again. One that is not in the register is ignored.
	void mark(const ScatterShape3D *shape);

	/// True if the path that a shape follows has changed. To be asked in every frame: paths do not tell.
	bool paths_changed();

	/// All shapes have to be looked at again. False if there are none.
	bool mark_all();

	/// Looks at the shapes that were marked. After the scene was `recentered`, one that stands in the world where it stood is
	/// the same shape: to within what single precision makes of that.
	void update(bool recentered);

	/// The shapes that count for the layer of this name at a place in the node's list; null for none. The same pointer
	/// as last time while nothing has changed.
	std::shared_ptr<const ShapeSet> set_for(std::size_t place, const godot::String &name);

	/// Has the editor ask all shapes for their warnings again.
	void update_warnings() const;

private:
	struct Entry {
		ScatterShape3D *node = nullptr;
		bool marked = true;
		std::optional<Shape> shape; ///< None while it has no effect.
		std::optional<Shape> read;  ///< As its node said last: the same, but for rounding.
		godot::PackedStringArray names;

		bool counts_for(const godot::String &name) const;
	};

	std::vector<Entry> entries_;
	std::vector<std::shared_ptr<const ShapeSet>> sets_; ///< As last handed out, by place.
};

} // namespace thicket
