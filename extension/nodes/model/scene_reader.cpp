#include "nodes/model/scene_reader.hpp"

#include "core/base/basis_scale.hpp"
#include "core/model/model_lods.hpp"
#include "nodes/common/boxes.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/stripped.hpp"
#include "nodes/model/mesh_merge.hpp"
#include "nodes/model/part_appearance.hpp"

#include <godot_cpp/classes/collision_shape3d.hpp>
#include <godot_cpp/classes/geometry_instance3d.hpp>
#include <godot_cpp/classes/mesh_instance3d.hpp>
#include <godot_cpp/classes/node3d.hpp>
#include <godot_cpp/classes/skin.hpp>
#include <godot_cpp/core/memory.hpp>
#include <godot_cpp/core/object.hpp>

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <array>
#include <optional>
#include <string>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

constexpr int64_t max_remarks = 8;

/// Values of GeometryInstance3D.ShadowCastingSetting.
constexpr int64_t shadow_off = 0;
constexpr int64_t shadow_on = 1;
constexpr int64_t shadows_only = 3;

/// A MeshInstance3D of the scene.
struct ScenePart {
	MeshPart part;
	PartRange range;
	int64_t cast_shadow = shadow_on;
	PartAppearance appearance;
};

/// Values that a node passes to its children.
struct ParentState {
	Transform3D transform;
	std::optional<int> lod;
};

Transform3D combined(const Transform3D &p_outer, const Transform3D &p_inner) {
	const glm::dmat3 outer = to_core(p_outer.basis);
	const glm::dmat3 basis = outer * to_core(p_inner.basis);
	return {Basis(to_engine(basis[0]), to_engine(basis[1]), to_engine(basis[2])),
			to_engine(outer * to_core(p_inner.origin) + to_core(p_outer.origin))};
}

std::string text_of(const StringName &p_name) { return String(p_name).utf8().get_data(); }

/// Walks over the nodes of a scene and collects its content. Continues after a problem and keeps
/// the first one.
class SceneWalk {
public:
	void visit(Node *p_node, const ParentState &parent_state, bool is_root);

	String problem;
	std::vector<ScenePart> parts;
	std::vector<ModelShape> shapes;
	PackedStringArray remarks;
	std::set<std::string> parameter_names; ///< The instance shader parameters that the scene sets.
	/// Materials, keyed by the names of the materials they replace.
	Dictionary replacements;

	void remark(const String &p_sentence);

private:
	void add_mesh(MeshInstance3D *p_node, const ParentState &state, const LodName &name);
	void add_shape(CollisionShape3D *p_node, const ParentState &state);
	void remark_on(Node *p_node);
	void fail(const String &p_problem);
	bool accept(Node *p_node, const Transform3D &p_transform);
};

void SceneWalk::fail(const String &p_problem) {
	if (problem.is_empty()) {
		problem = p_problem;
	}
}

void SceneWalk::remark(const String &p_sentence) {
	if (remarks.size() < max_remarks && !remarks.has(p_sentence)) {
		remarks.push_back(p_sentence);
	}
}

/// Reads a node and its descendants. Skips hidden nodes.
void SceneWalk::visit(Node *p_node, const ParentState &parent_state, bool is_root) {
	const LodName name = read_lod_name(text_of(p_node->get_name()));
	ParentState state = parent_state;
	state.lod = name.lod ? name.lod : parent_state.lod;
	if (auto *node = Object::cast_to<Node3D>(p_node)) {
		if (!is_root && !node->is_visible()) {
			return;
		}
		state.transform = is_root ? Transform3D() : combined(parent_state.transform, node->get_transform());
	}
	if (auto *mesh = Object::cast_to<MeshInstance3D>(p_node)) {
		add_mesh(mesh, state, name);
	} else if (auto *shape = Object::cast_to<CollisionShape3D>(p_node)) {
		add_shape(shape, state);
	} else {
		remark_on(p_node);
	}
	for (int32_t child = 0; child < p_node->get_child_count() && parts.size() <= max_model_parts; ++child) {
		visit(p_node->get_child(child), state, false);
	}
}

/// Returns false and records a problem if a transform is flat.
bool SceneWalk::accept(Node *p_node, const Transform3D &p_transform) {
	constexpr double min_relative_volume = 1e-9; // Relative to the volume of a cube of the greatest extent.
	const glm::dmat3 basis = to_core(p_transform.basis);
	const double extent = largest_scale(basis);
	const double volume = glm::determinant(basis);
	if (!(std::abs(volume) > min_relative_volume * extent * extent * extent)) {
		fail(vformat("\"%s\" has a scale of 0 along an axis", p_node->get_name()));
		return false;
	}
	return true;
}

std::vector<double> blend_weights_of(const MeshInstance3D &node) {
	std::vector<double> weights;
	for (int32_t shape = 0; shape < node.get_blend_shape_count(); ++shape) {
		weights.push_back(node.get_blend_shape_value(shape));
	}
	const bool are_all_zero = std::ranges::all_of(weights, [](double weight) { return weight == 0.0; });
	return are_all_zero ? std::vector<double>() : weights;
}

/// Adds a part for a node that has a mesh.
void SceneWalk::add_mesh(MeshInstance3D *p_node, const ParentState &state, const LodName &name) {
	const Ref<Mesh> mesh = p_node->get_mesh();
	if (mesh.is_null() || (mesh->get_surface_count() == 0 && !is_stripped(mesh))) {
		return;
	}
	if (parts.size() >= max_model_parts) {
		fail(vformat("it has more than %d meshes", static_cast<int64_t>(max_model_parts)));
		parts.emplace_back(); // The number of parts is now above the limit, so the walk ends.
		return;
	}
	if (!accept(p_node, state.transform)) {
		return;
	}
	if (p_node->get_skin().is_valid()) {
		remark(vformat("\"%s\" has a skeleton: it is drawn in its rest pose.", p_node->get_name()));
	}
	ScenePart part;
	part.part = {mesh, state.transform, {}, p_node->get_material_overlay(), blend_weights_of(*p_node)};
	part.appearance = appearance_of(*p_node, parameter_names);
	const Ref<Material> override_material = p_node->get_material_override();
	for (int32_t surface = 0; surface < mesh->get_surface_count(); ++surface) {
		const Ref<Material> material =
				override_material.is_valid() ? override_material : p_node->get_surface_override_material(surface);
		part.part.materials.push_back(drawn_material(material, mesh, surface, replacements));
	}
	part.range = {name.stem, state.lod, p_node->get_visibility_range_begin(), p_node->get_visibility_range_end()};
	part.cast_shadow = static_cast<int64_t>(p_node->get_cast_shadows_setting());
	parts.push_back(std::move(part));
}

/// Adds the shape of a node, or a remark if bodies cannot have such a shape.
void SceneWalk::add_shape(CollisionShape3D *p_node, const ParentState &state) {
	constexpr std::array supported_classes{
			"BoxShape3D", "SphereShape3D", "CapsuleShape3D", "CylinderShape3D", "ConvexPolygonShape3D"};
	const Ref<Shape3D> shape = p_node->get_shape();
	if (shape.is_null() || p_node->is_disabled()) {
		return;
	}
	const String kind = shape->get_class();
	const bool is_supported =
			std::ranges::any_of(supported_classes, [&](const char *name) { return kind == String(name); });
	if (!is_supported) {
		remark(vformat(
				"\"%s\" is left out: a %s cannot be the shape of a scattered body. Use a box, a sphere, a capsule, a "
				"cylinder or a convex polygon.",
				p_node->get_name(), kind));
	} else if (accept(p_node, state.transform)) {
		Transform3D transform = state.transform;
		if (glm::determinant(to_core(transform.basis)) < 0.0) {
			// The engine's shapes cannot be mirrored, but all except convex polygons are symmetric.
			if (kind == String("ConvexPolygonShape3D")) {
				remark(vformat("\"%s\" is left out: a convex polygon cannot have a negative scale. Apply its transform "
							   "in the modeling tool.",
						p_node->get_name()));
				return;
			}
			glm::dmat3 basis = to_core(transform.basis);
			basis[0] = -basis[0];
			transform.basis = to_engine(glm::mat3(basis));
		}
		shapes.push_back({shape, transform});
	}
}

/// Adds a remark about a node that is not drawn as it is in the scene.
void SceneWalk::remark_on(Node *p_node) {
	if (p_node->is_class("AnimationMixer")) {
		remark(vformat("\"%s\" does not play: the model is drawn as the scene was saved.", p_node->get_name()));
	} else if (p_node->is_class("VisualInstance3D")) {
		remark(vformat("\"%s\" is not drawn: it is a %s, and only MeshInstance3D nodes are scattered.",
				p_node->get_name(), p_node->get_class()));
	}
}

/// Merges the meshes of parts. Omits parts whose shadow setting is `omitted_setting`.
Ref<Mesh> mesh_of(
		const std::vector<ScenePart> &parts, const std::vector<std::size_t> &part_indices, int64_t omitted_setting) {
	std::vector<MeshPart> drawn_parts;
	for (const std::size_t part : part_indices) {
		if (parts[part].cast_shadow != omitted_setting) {
			drawn_parts.push_back(parts[part].part);
		}
	}
	return merged_mesh(drawn_parts);
}

/// Creates an LOD. If the shadow settings of its parts differ, it has a separate shadow mesh.
Ref<ScatterLod> make_lod(const std::vector<ScenePart> &parts, const ModelLod &lod) {
	constexpr int64_t no_setting = -1;
	Ref<ScatterLod> result(memnew(ScatterLod));
	result->set_distance(lod.distance.value_or(0.0));
	const int64_t first = parts[lod.parts.front()].cast_shadow;
	if (std::ranges::all_of(lod.parts, [&](std::size_t part) { return parts[part].cast_shadow == first; })) {
		result->set_mesh(mesh_of(parts, lod.parts, no_setting));
		// A node with the default setting uses the layer's setting.
		result->set_cast_shadow(
				first == shadow_on ? ScatterLod::CAST_SHADOW_LAYER : static_cast<ScatterLod::CastShadow>(first));
	} else {
		result->set_mesh(mesh_of(parts, lod.parts, shadows_only));
		result->set_shadow_mesh(mesh_of(parts, lod.parts, shadow_off));
	}
	return result;
}

/// Sets the appearance of an LOD from its visible parts. Parts that only cast shadows are ignored.
void join_lod_appearances(SceneWalk &r_walk, const std::vector<std::size_t> &parts, ScatterLod &r_lod) {
	std::vector<const PartAppearance *> appearances;
	for (const std::size_t part : parts) {
		if (r_walk.parts[part].cast_shadow != shadows_only) {
			appearances.push_back(&r_walk.parts[part].appearance);
		}
	}
	PackedStringArray remarks;
	if (!appearances.empty()) {
		join_appearances(appearances, r_lod, remarks);
	}
	for (const String &sentence : remarks) {
		r_walk.remark(sentence);
	}
}

/// Returns the transform from the space of a node's parent to the root's space. The transform also
/// moves the node horizontally to x = z = 0.
Transform3D parent_transform_of(const Node *p_root, const Node *p_node) {
	Transform3D transform;
	for (const Node *node = p_node->get_parent(); node != nullptr && node != p_root; node = node->get_parent()) {
		if (const auto *parent = Object::cast_to<Node3D>(node)) {
			transform = combined(parent->get_transform(), transform);
		}
	}
	if (const auto *node = Object::cast_to<Node3D>(p_node)) {
		const Vector3 origin = combined(transform, node->get_transform()).origin;
		transform.origin.x -= origin.x;
		transform.origin.z -= origin.z;
	}
	return transform;
}

/// Moves all parts horizontally so that their bounding box is centered at the origin. Does nothing
/// if the x and z ranges of the box already contain the origin.
void center_parts(SceneWalk &r_walk) {
	std::optional<AABB> box;
	for (const ScenePart &part : r_walk.parts) {
		if (part.part.mesh.is_valid()) {
			const AABB part_box = transformed(part.part.mesh->get_aabb(), part.part.transform);
			box = box ? joined(*box, part_box) : part_box;
		}
	}
	if (!box) {
		return;
	}
	const Vector3 end = box->position + box->size;
	if (box->position.x <= 0 && end.x >= 0 && box->position.z <= 0 && end.z >= 0) {
		return;
	}
	const Vector3 shift((box->position.x + end.x) / -2, 0, (box->position.z + end.z) / -2);
	for (ScenePart &part : r_walk.parts) {
		part.part.transform.origin = part.part.transform.origin + shift;
	}
	for (ModelShape &shape : r_walk.shapes) {
		shape.transform.origin = shape.transform.origin + shift;
	}
}

/// Instantiates a scene and walks over it, or over the node at path `p_part`. Fills `r_walk`, or
/// sets its problem.
void walk_scene(const Ref<PackedScene> &p_scene, const String &p_part, SceneWalk &r_walk) {
	if (!p_scene->can_instantiate()) {
		r_walk.problem = empty_scene;
		return;
	}
	Node *root = p_scene->instantiate();
	if (root == nullptr) {
		r_walk.problem = "it cannot be instantiated";
		return;
	}
	r_walk.parameter_names = instance_parameters_of(p_scene);
	if (p_part.is_empty()) {
		r_walk.visit(root, {}, true);
	} else if (Node *node = root->get_node_or_null(NodePath(p_part)); node != nullptr && node != root) {
		r_walk.visit(node, {parent_transform_of(root, node), {}}, false);
		center_parts(r_walk);
	} else {
		r_walk.problem = vformat("its root has no descendant \"%s\", the path in ScatterModel.scene_part", p_part);
	}
	memdelete(root);
}

std::vector<ModelLod> lods_of(const SceneWalk &walk) {
	std::vector<PartRange> ranges;
	for (const ScenePart &part : walk.parts) {
		ranges.push_back(part.range);
	}
	return model_lods(ranges);
}

} // namespace

struct SceneReader::Progress {
	Ref<PackedScene> scene;
	String part;
	bool is_walked = false;
	SceneWalk walk;
	std::vector<ModelLod> lods; ///< The meshes of the first `merged_count` LODs have been read.
	std::size_t merged_count = 0;
	SceneReading result;
};

SceneReader::SceneReader(const Ref<PackedScene> &p_scene, const String &p_part, const Dictionary &p_materials) :
		progress_(std::make_unique<Progress>()) {
	progress_->scene = p_scene;
	progress_->part = p_part;
	progress_->walk.replacements = p_materials;
}

SceneReader::~SceneReader() = default;

bool SceneReader::step() {
	Progress &progress = *progress_;
	if (!std::exchange(progress.is_walked, true)) {
		walk_scene(progress.scene, progress.part, progress.walk);
		if (progress.walk.problem.is_empty()) {
			progress.lods = lods_of(progress.walk);
		}
		return true;
	}
	if (progress.merged_count == progress.lods.size()) {
		return false;
	}
	const std::vector<std::size_t> &parts = progress.lods[progress.merged_count].parts;
	const Ref<ScatterLod> lod = make_lod(progress.walk.parts, progress.lods[progress.merged_count++]);
	if (lod->get_mesh().is_valid()) {
		join_lod_appearances(progress.walk, parts, *lod.ptr());
		progress.result.lods.push_back(lod);
	}
	return true;
}

SceneReading SceneReader::take() {
	Progress &progress = *progress_;
	progress.result.problem = progress.walk.problem;
	if (progress.result.lods.empty() && progress.result.problem.is_empty()) {
		progress.result.problem = "it has no visible MeshInstance3D with a mesh";
	}
	if (progress.result.problem.is_empty()) {
		progress.result.shapes = std::move(progress.walk.shapes);
		progress.result.remarks = progress.walk.remarks;
	}
	return std::move(progress.result);
}

} // namespace thicket
