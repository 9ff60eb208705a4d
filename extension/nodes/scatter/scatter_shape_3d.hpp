#pragma once

#include "core/rules/shapes.hpp"
#include "nodes/common/property_check.hpp"

#include <godot_cpp/classes/node3d.hpp>
#include <godot_cpp/classes/path3d.hpp>
#include <godot_cpp/variant/node_path.hpp>
#include <godot_cpp/variant/packed_string_array.hpp>
#include <godot_cpp/variant/packed_vector2_array.hpp>
#include <godot_cpp/variant/packed_vector3_array.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace thicket {

class TerrainScatter3D;

/// The sizes of a shape, as the inspector shows them, in meters.
struct ShapeNumbers {
	double falloff = 0.0;
	double radius = 5.0;
	double height = 10.0;
	double width = 4.0;
};

/// A part of the world in which layers of the TerrainScatter3D above it are included, or from which they are excluded.
/// Counts while it is in the tree and not hidden. What it changes is made anew, and nothing else.
class ScatterShape3D : public godot::Node3D {
	GDCLASS(ScatterShape3D, godot::Node3D)

public:
	enum Kind {
		KIND_BOX,      ///< `size`, around the node.
		KIND_SPHERE,   ///< `radius`.
		KIND_CYLINDER, ///< `radius`, and `height` along the node's y axis.
		KIND_POLYGON,  ///< Within `polygon`, at any height.
		KIND_PATH,     ///< Within half of `width` of a Path3D, at any height.
	};

	ScatterShape3D();

	/// A setter refuses what is not finite or out of range: one error that names the property, and the value stays.
	void set_kind(Kind p_kind);
	Kind get_kind() const { return kind_; }
	void set_exclude(bool p_exclude);
	bool is_excluding() const { return exclude_; }

	/// Names of the layers that the shape counts for; none for all of them.
	void set_layer_names(const godot::PackedStringArray &p_names);
	godot::PackedStringArray get_layer_names() const { return layer_names_; }
	void set_ignore_height(bool p_ignore);
	bool is_ignoring_height() const { return ignore_height_; }

	/// Sides of the box in meters, each 0.001 to 1e6, before the node's scale.
	void set_size(const godot::Vector3 &p_size);
	godot::Vector3 get_size() const { return size_; }

	/// Corners as the node's own x and z, closed by itself, at most max_outline_points.
	void set_polygon(const godot::PackedVector2Array &p_polygon);
	godot::PackedVector2Array get_polygon() const { return polygon_; }

	/// A Path3D; empty: the parent, if it is one.
	void set_path_node(const godot::NodePath &p_path);
	godot::NodePath get_path_node() const { return path_; }

	template <const NumberProperty<ShapeNumbers, double> &property>
	void set_number(double p_value);
	template <const NumberProperty<ShapeNumbers, double> &property>
	double get_number() const;

	/// The shape as it stands in the world. None where it has no effect: hidden, not in the tree, unfinished, or such
	/// that the core refuses it, for which one error is printed.
	std::optional<Shape> world_shape();

	/// True if the path that a shape of KIND_PATH follows is another one, has moved or has changed since the last call.
	bool path_changed();

	/// What keeps the shape from having the effect that is likely meant, a sentence each, for the editor's warnings.
	godot::PackedStringArray get_problems() const;
	godot::PackedStringArray _get_configuration_warnings() const override { return get_problems(); }

protected:
	static void _bind_methods();
	void _notification(int p_what);

private:
	void enter();
	void leave();
	void changed();
	bool shown() const;
	/// ErrorCode::missing for an outline with too few points.
	bool is_flat() const { return kind_ == KIND_POLYGON || kind_ == KIND_PATH; }
	Status build(Shape &r_shape) const;
	Status build_solid(Shape &r_shape) const;
	std::vector<glm::dvec2> polygon_outline() const;
	std::vector<glm::dvec2> path_outline() const;
	godot::Path3D *followed_path() const;
	void add_outline_problems(godot::PackedStringArray &r_problems) const;
	template <const NumberProperty<ShapeNumbers, double> &property>
	static void bind_number();

	Kind kind_ = KIND_BOX;
	bool exclude_ = false;
	bool ignore_height_ = false;
	godot::PackedStringArray layer_names_;
	godot::Vector3 size_{10.0F, 10.0F, 10.0F};
	ShapeNumbers numbers_;
	godot::PackedVector2Array polygon_;
	godot::NodePath path_;

	TerrainScatter3D *scatter_ = nullptr; ///< Between entering and leaving the tree; it leaves after what is below it.
	ErrorCode reported_ = ErrorCode::none;

	/// Of the path, as path_changed() saw it last.
	struct SeenPath {
		std::uint64_t id = 0;
		godot::Transform3D transform;
		godot::PackedVector3Array
				points; ///< Shares its memory with the curve's, which lies elsewhere once that changes.
	};
	SeenPath seen_;
};

} // namespace thicket

VARIANT_ENUM_CAST(thicket::ScatterShape3D::Kind)
