#pragma once

#include "core/base/planet.hpp"
#include "core/base/world_frame.hpp"
#include "core/rules/planet_map.hpp"
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

/// The interface through which a region notifies its closest TerrainScatter3D ancestor.
class RegionHost {
public:
	virtual ~RegionHost() = default;

	/// A region calls these three functions when it enters the tree, leaves the tree, or has
	/// changed. The host then regenerates the affected area.
	virtual void add_region(ScatterRegion3D *p_region) = 0;
	virtual void remove_region(ScatterRegion3D *p_region) = 0;
	virtual void region_changed(const ScatterRegion3D *p_region) = 0;

	/// The relation between the engine's space and the host's world.
	virtual const WorldFrame &world_frame() const = 0;

	/// Returns the planet that the host's ground forms, in the host's world.
	virtual Planet planet() const = 0;

	/// Returns the transform of a node in the tree: in the host's local space if the world is that
	/// space, otherwise the global one.
	virtual godot::Transform3D transform_of(const godot::Node3D &p_node) const = 0;

	/// Returns a message if a reference (see stored_reference) matches none of the host's layers;
	/// otherwise an empty string.
	virtual godot::String layer_problem(const godot::Variant &p_reference) const = 0;
};

/// The numeric properties of a region, all in meters.
struct RegionSizes {
	double falloff = 0.0;
	double radius = 5.0;
	double height = 10.0;
	double width = 4.0;
};

/// A part of the world from which layers of the region's closest TerrainScatter3D ancestor are
/// excluded, or to which they are confined. Has an effect only while it is visible and in the tree.
/// When the region changes, only the tiles that it touches are regenerated.
class ScatterRegion3D : public godot::Node3D, public ThreadGuarded {
	GDCLASS(ScatterRegion3D, godot::Node3D)
	THICKET_GUARDED_METHODS(owner)

public:
	static constexpr const char *class_name = "ScatterRegion3D";

	enum Shape {
		SHAPE_BOX,      ///< A box of `size`, centered on the node.
		SHAPE_SPHERE,   ///< A sphere of `radius`.
		SHAPE_CYLINDER, ///< A cylinder of `radius`, and `height` along the node's y axis.
		SHAPE_POLYGON,  ///< The inside of `polygon`, at any height.
		SHAPE_PATH,     ///< A strip of `width` along a Path3D, at any height.
	};

	ScatterRegion3D();

	// If a value is out of range or not finite, every setter prints an error that names the
	// property and keeps the old value.
	void set_shape(Shape p_shape);
	Shape get_shape() const { return shape_; }

	/// Sets whether layers are excluded from the region (true) or confined to it (false).
	void set_exclude(bool p_exclude);
	bool is_excluding() const { return exclude_; }

	/// Sets the layers that the region affects, each a ScatterLayer or its name; empty for all
	/// layers. Named layers are stored by name. The returned array is a read-only copy.
	void set_layers(const godot::Array &p_layers);
	godot::Array get_layers() const;

	void change_references(const ReferenceChange &change);

	/// Sets whether a box, sphere or cylinder affects all heights within its outline as seen from
	/// above.
	void set_ignore_height(bool p_ignore);
	bool is_ignoring_height() const { return ignore_height_; }

	/// Sets the edge lengths of the box in meters, each 0.001 to 1e6, before the node's scale is
	/// applied.
	void set_size(const godot::Vector3 &p_size);
	godot::Vector3 get_size() const { return size_; }

	/// Sets the corners of a closed polygon in the node's local x and z, at most
	/// max_outline_points.
	void set_polygon(const godot::PackedVector2Array &p_polygon);
	godot::PackedVector2Array get_polygon() const { return polygon_; }

	/// Sets the Path3D to follow. If empty, the region follows its parent, provided that it is a
	/// Path3D.
	void set_path_node(const godot::NodePath &p_path);
	godot::NodePath get_path_node() const { return path_; }

	template <const NumberProperty<RegionSizes, double> &property>
	void set_number(double p_value);
	template <const NumberProperty<RegionSizes, double> &property>
	double get_number() const;

	/// Returns the region's shape in the world. Returns nothing if the region is hidden, not in the
	/// tree or incomplete, or if the core rejects the shape. Prints an error for a rejected shape,
	/// but only once until the reason changes.
	std::optional<thicket::Shape> world_shape();

	/// Returns true if the Path3D of a SHAPE_PATH region was replaced, moved or changed since the
	/// last call.
	bool path_changed();

	// These methods are for the add-on's gizmos. Without a planet, and for a region at its center,
	// they return empty arrays.

	/// Converts positions from the engine's space to the flat map of the planet around the region: a
	/// PlanetMap for a polygon or a path, otherwise the plane onto which the region is projected. In
	/// the result, x and z are the position on the map, and y is the map's scale there.
	godot::PackedVector3Array to_planet_map(const godot::PackedVector3Array &p_positions) const;

	/// Returns the up directions, in the engine's space, at positions on this map.
	godot::PackedVector3Array from_planet_map(const godot::PackedVector2Array &p_map_positions) const;

	/// Returns a message for each problem that keeps the region from having its likely intended
	/// effect. The editor shows them as configuration warnings.
	godot::PackedStringArray get_problems() const;
	godot::PackedStringArray _get_configuration_warnings() const override {
		return guarded_call("ScatterRegion3D._get_configuration_warnings", [this] { return get_problems(); });
	}

protected:
	static void _bind_methods();
	void _notification(int p_what);
	void _validate_property(godot::PropertyInfo &p_property) const;

private:
	godot::Transform3D transform_of(const godot::Node3D &node) const;
	void handle_notification(int p_what);
	void enter();
	void leave();
	void notify_change();
	bool is_visible_below_host() const;
	bool is_flat() const { return shape_ == SHAPE_POLYGON || shape_ == SHAPE_PATH; }
	/// Returns ErrorCode::missing for an outline with too few points.
	Status build(thicket::Shape &r_shape) const;
	Status build_solid(thicket::Shape &r_shape) const;
	Planet planet() const { return host_ != nullptr ? host_->planet() : Planet(); }
	glm::dvec3 to_world(const godot::Transform3D &frame, glm::dvec3 position) const;
	std::vector<glm::dvec3> polygon_corners() const;
	std::vector<glm::dvec3> path_points() const;
	void build_outline(const Planet &planet, thicket::Shape &r_shape) const;
	std::optional<PlanetMap> planet_map(glm::dvec3 &r_center) const;
	godot::Path3D *followed_path() const;
	void add_outline_problems(godot::PackedStringArray &r_problems) const;
	void add_planet_problems(godot::PackedStringArray &r_problems) const;
	template <const NumberProperty<RegionSizes, double> &property>
	static void bind_number();

	Shape shape_ = SHAPE_BOX;
	bool exclude_ = true;
	bool ignore_height_ = false;
	godot::Array layers_; ///< Converted by stored_reference.
	godot::Vector3 size_{10.0F, 10.0F, 10.0F};
	RegionSizes numbers_;
	godot::PackedVector2Array polygon_;
	godot::NodePath path_;

	/// The host of the region while it is in the tree. The pointer stays valid, because the host
	/// leaves the tree after its descendants.
	RegionHost *host_ = nullptr;
	ErrorCode reported_error_ = ErrorCode::none;

	/// The state of the path in the last call of path_changed().
	struct PathState {
		std::uint64_t id = 0;
		godot::Transform3D transform;
		/// Shares the curve's memory. The curve allocates a new array when it changes.
		godot::PackedVector3Array points;
	};
	godot::Transform3D reported_transform_; ///< See transform_of(). The transform that was last reported.
	PathState last_path_;
};

} // namespace thicket

VARIANT_ENUM_CAST(thicket::ScatterRegion3D::Shape)
