#pragma once

#include "core/rules/shapes.hpp"
#include "nodes/common/guard.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/layer/reference_change.hpp"

#include <godot_cpp/classes/node3d.hpp>
#include <godot_cpp/classes/path3d.hpp>
#include <godot_cpp/variant/array.hpp>
#include <godot_cpp/variant/node_path.hpp>
#include <godot_cpp/variant/packed_string_array.hpp>
#include <godot_cpp/variant/packed_vector2_array.hpp>
#include <godot_cpp/variant/packed_vector3_array.hpp>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace thicket {

class ScatterRegion3D;

/// A node that the regions below it belong to: a TerrainScatter3D.
class RegionHost {
public:
	virtual ~RegionHost() = default;

	/// Call these when a region below the node enters the tree, leaves it, or has changed. The affected area is
	/// regenerated.
	virtual void add_region(ScatterRegion3D *p_region) = 0;
	virtual void remove_region(ScatterRegion3D *p_region) = 0;
	virtual void region_changed(const ScatterRegion3D *p_region) = 0;

	/// The world position of the engine's origin, in meters.
	virtual glm::dvec3 world_offset() const = 0;

	/// A sentence that explains why a reference (see find_layer) refers to none of the node's layers; empty if it
	/// refers to one.
	virtual godot::String layer_problem(const godot::Variant &p_reference) const = 0;
};

/// The sizes of a region, as the inspector shows them, in meters.
struct RegionSizes {
	double falloff = 0.0;
	double radius = 5.0;
	double height = 10.0;
	double width = 4.0;
};

/// A part of the world that excludes layers of the TerrainScatter3D above it, or includes them. A region has an effect
/// only while it is in the tree and visible. When it changes, only the tiles that it touches are regenerated.
class ScatterRegion3D : public godot::Node3D, public ThreadGuarded {
	GDCLASS(ScatterRegion3D, godot::Node3D)
	THICKET_GUARDED_METHODS(owner)

public:
	static constexpr const char *class_name = "ScatterRegion3D";

	enum Shape {
		SHAPE_BOX,      ///< `size`, around the node.
		SHAPE_SPHERE,   ///< `radius`.
		SHAPE_CYLINDER, ///< `radius`, and `height` along the node's y axis.
		SHAPE_POLYGON,  ///< Inside `polygon`, at any height.
		SHAPE_PATH,     ///< Within half of `width` of a Path3D, at any height.
	};

	ScatterRegion3D();

	/// A setter refuses values that are not finite or out of range: it prints one error that names the property, and keeps the old value.
	void set_shape(Shape p_shape);
	Shape get_shape() const { return shape_; }
	void set_exclude(bool p_exclude);
	bool is_excluding() const { return exclude_; }

	/// The layers that the region affects, each a ScatterLayer or its name; empty for all layers. A layer that has a
	/// name is stored by name. The returned array is read-only.
	void set_layers(const godot::Array &p_layers);
	godot::Array get_layers() const;

	void change_references(const ReferenceChange &change);
	void set_ignore_height(bool p_ignore);
	bool is_ignoring_height() const { return ignore_height_; }

	/// The sides of the box in meters, each 0.001 to 1e6, before the node's scale is applied.
	void set_size(const godot::Vector3 &p_size);
	godot::Vector3 get_size() const { return size_; }

	/// Corners in the node's own x and z, closed automatically, at most max_outline_points.
	void set_polygon(const godot::PackedVector2Array &p_polygon);
	godot::PackedVector2Array get_polygon() const { return polygon_; }

	/// A Path3D; if empty, the parent if it is one.
	void set_path_node(const godot::NodePath &p_path);
	godot::NodePath get_path_node() const { return path_; }

	template <const NumberProperty<RegionSizes, double> &property>
	void set_number(double p_value);
	template <const NumberProperty<RegionSizes, double> &property>
	double get_number() const;

	/// The shape of the region in the world. Empty if the region has no effect: if it is hidden, not in the tree,
	/// unfinished, or refused by the core. A refusal prints one error.
	std::optional<thicket::Shape> world_shape();

	/// True if the path that a region of SHAPE_PATH follows was replaced, moved or changed since the last call.
	bool path_changed();

	/// One sentence for each problem that probably keeps the region from its intended effect, for the editor's
	/// warnings.
	godot::PackedStringArray get_problems() const;
	godot::PackedStringArray _get_configuration_warnings() const override {
		return guarded_call("ScatterRegion3D._get_configuration_warnings", [this] { return get_problems(); });
	}

protected:
	static void _bind_methods();
	void _notification(int p_what);
	void _validate_property(godot::PropertyInfo &p_property) const;

private:
	void notified(int p_what);
	void enter();
	void leave();
	void changed();
	bool shown() const;
	bool is_flat() const { return shape_ == SHAPE_POLYGON || shape_ == SHAPE_PATH; }
	/// ErrorCode::missing for an outline with too few points.
	Status build(thicket::Shape &r_shape) const;
	Status build_solid(thicket::Shape &r_shape) const;
	std::vector<glm::dvec2> polygon_outline() const;
	std::vector<glm::dvec2> path_outline() const;
	godot::Path3D *followed_path() const;
	void add_outline_problems(godot::PackedStringArray &r_problems) const;
	template <const NumberProperty<RegionSizes, double> &property>
	static void bind_number();

	Shape shape_ = SHAPE_BOX;
	bool exclude_ = true;
	bool ignore_height_ = false;
	godot::Array layers_; ///< In the form of stored_reference.
	godot::Vector3 size_{10.0F, 10.0F, 10.0F};
	RegionSizes numbers_;
	godot::PackedVector2Array polygon_;
	godot::NodePath path_;

	RegionHost *host_ = nullptr; ///< Set while in the tree. The host leaves the tree after its descendants.
	ErrorCode reported_ = ErrorCode::none;

	/// The path, as path_changed() last saw it.
	struct SeenPath {
		std::uint64_t id = 0;
		godot::Transform3D transform;
		godot::PackedVector3Array
				points; ///< Shares the curve's memory. When the curve changes, its points get new memory.
	};
	SeenPath seen_;
};

} // namespace thicket

VARIANT_ENUM_CAST(thicket::ScatterRegion3D::Shape)
