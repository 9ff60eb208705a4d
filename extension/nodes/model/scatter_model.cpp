#include "nodes/model/scatter_model.hpp"

#include "core/model/model_lods.hpp"
#include "nodes/common/boxes.hpp"
#include "nodes/common/engine_arrays.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/common/threads.hpp"
#include "nodes/common/watch.hpp"

#include <godot_cpp/classes/resource_loader.hpp>
#include <godot_cpp/core/error_macros.hpp>
#include <godot_cpp/core/object.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// Properties that are read from the scene if there is one.
constexpr std::array read_properties{"lods", "shapes", "shape_transforms"};

TypedArray<ScatterLod> array_of(const std::vector<Ref<ScatterLod>> &lods) {
	TypedArray<ScatterLod> result;
	for (const Ref<ScatterLod> &lod : lods) {
		append(result, lod);
	}
	return result;
}

/// Sets a flag for the lifetime of this object.
class FlagScope {
public:
	explicit FlagScope(bool &r_flag) : flag_(r_flag) { flag_ = true; }
	~FlagScope() { flag_ = false; }
	FlagScope(const FlagScope &) = delete;
	FlagScope &operator=(const FlagScope &) = delete;

private:
	bool &flag_;
};

/// Returns true if the number of LODs is allowed. Otherwise prints an error.
bool accept_count(const char *p_property, const TypedArray<ScatterLod> &p_lods) {
	const bool is_allowed = p_lods.size() <= ScatterModel::max_model_lods;
	if (!is_allowed) {
		report(ScatterModel::class_name,
				Status::out_of_range(p_property, p_lods.size(), at_most(ScatterModel::max_model_lods, "entries")));
	}
	return is_allowed;
}

/// Appends an LOD with all defaults resolved. A null mesh means the mesh of the previous LOD.
void add_drawn_lod(const Ref<ScatterLod> &p_lod, std::vector<DrawnLod> &r_lods) {
	const Ref<Mesh> mesh = p_lod->get_mesh().is_valid() ? p_lod->get_mesh() : r_lods.back().mesh;
	double distance = 0.0;
	if (!r_lods.empty()) {
		const double size = r_lods.front().mesh->get_aabb().size.length();
		distance = p_lod->get_distance() > 0.0 ? p_lod->get_distance() : usual_lod_distance(size, r_lods.size());
	}
	r_lods.push_back({distance, mesh, p_lod->get_shadow_mesh(), p_lod->get_cast_shadow(), p_lod->appearance()});
}

void print_problem(const Ref<PackedScene> &p_scene, const String &p_problem) {
	ERR_PRINT(vformat("ScatterModel.scene: %s is invalid: %s.", name_of(p_scene), p_problem));
}

} // namespace

String name_of(const Ref<PackedScene> &p_scene) {
	const String path = p_scene->get_path();
	return path.is_empty() ? String("a scene without a file") : path;
}

void ScatterModel::set_scene(const Ref<PackedScene> &p_scene) {
	if (scene_ == p_scene) {
		return;
	}
	if (p_scene.is_valid() && !p_scene->can_instantiate()) {
		print_problem(p_scene, empty_scene);
		return;
	}
	scene_ = p_scene;
	if (p_scene.is_valid()) {
		unread_scene_ = p_scene;
		reader_ = nullptr;
		set_by_hand_ = {};
		problem_ = String();
	} else {
		source_scene_ = p_scene;
	}
	notify_property_list_changed();
	emit_changed();
}

void ScatterModel::set_scene_part(const String &p_path) {
	if (scene_part_ == p_path) {
		return;
	}
	scene_part_ = p_path;
	schedule_reread();
}

void ScatterModel::set_replacement_materials(const Dictionary &p_materials) {
	Dictionary materials; // Use a copy, because scripts share dictionaries by reference.
	const Array names = p_materials.keys();
	for (int64_t index = 0; index < names.size(); ++index) {
		const Variant &name = names[index];
		const Ref<Material> material = p_materials[name];
		const bool is_text = name.get_type() == Variant::STRING || name.get_type() == Variant::STRING_NAME;
		if (!is_text || material.is_null()) {
			ERR_PRINT(vformat(
					"ScatterModel.replacement_materials must have the names of the scene's materials as keys, and a "
					"Material for each; got %s for %s. The last value is kept.",
					p_materials[name], name));
			return;
		}
		materials[static_cast<String>(name)] = material;
	}
	materials.make_read_only();
	replacement_materials_ = materials;
	schedule_reread();
}

/// Schedules the scene to be reread, because the settings for reading it have changed.
void ScatterModel::schedule_reread() {
	if (scene_.is_valid()) {
		unread_scene_ = scene_;
		reader_ = nullptr;
		problem_ = String();
		emit_changed();
	}
}

bool ScatterModel::read_step() {
	if (unread_scene_.is_null() || is_stepping_) {
		return false;
	}
	if (reader_ == nullptr) {
		reader_ = std::make_shared<SceneReader>(unread_scene_, scene_part_, replacement_materials_);
	}
	const std::shared_ptr<SceneReader> reader = reader_;
	bool has_more = false;
	{
		const FlagScope scope(is_stepping_);
		has_more = reader->step();
	}
	if (!has_more && reader == reader_) { // If the reader differs, a script has set another scene.
		finish_reading(reader->take());
	}
	return true;
}

void ScatterModel::read() {
	while (unread_scene_.is_valid() && on_main_thread() && read_step()) {}
}

void ScatterModel::finish_reading(const SceneReading &reading) {
	const Ref<PackedScene> scene = std::exchange(unread_scene_, {});
	reader_ = nullptr;
	if (!take_content(reading, scene) && scene_ == scene && !lods_.is_empty()) {
		scene_ = source_scene_;
		scene_part_ = source_part_;
		notify_property_list_changed();
	}
}

/// Replaces the model's content with that of a scene. If the scene has a problem, prints an error
/// and returns false.
bool ScatterModel::take_content(const SceneReading &reading, const Ref<PackedScene> &p_scene) {
	problem_ = lods_.is_empty() ? reading.problem : String();
	if (!reading.problem.is_empty()) {
		print_problem(p_scene, reading.problem);
		return false;
	}
	TypedArray<Shape3D> shapes;
	TypedArray<Transform3D> transforms;
	for (const ModelShape &shape : reading.shapes) {
		append(shapes, shape.shape);
		append(transforms, shape.transform);
	}
	source_scene_ = scene_;
	source_part_ = scene_part_;
	if (!set_by_hand_.lods) {
		replace_lods(lods_, array_of(reading.lods));
	}
	if (!set_by_hand_.shapes) {
		shapes_ = shapes;
	}
	if (!set_by_hand_.shape_transforms) {
		shape_transforms_ = transforms;
	}
	remarks_ = reading.remarks;
	return true;
}

bool ScatterModel::reload() {
	if (scene_.is_null()) {
		return true;
	}
	const String path = scene_->get_path();
	Ref<PackedScene> loaded_scene = scene_;
	// Bypass the cache: the cached scene may be older than its file, and the editor uses it as
	// well.
	if (!path.is_empty() && ResourceLoader::get_singleton()->exists(path)) {
		loaded_scene = ResourceLoader::get_singleton()->load(path, "PackedScene", ResourceLoader::CACHE_MODE_IGNORE);
	}
	if (loaded_scene.is_null()) {
		ERR_PRINT(vformat(
				"ScatterModel.scene: %s cannot be loaded. Check that the file exists and can be opened.", path));
		return false;
	}
	SceneReader reader(loaded_scene, scene_part_, replacement_materials_);
	const Ref<PackedScene> scene = scene_;
	while (reader.step()) {}
	if (!(scene == scene_)) {
		return true; // A script in the scene has set another scene.
	}
	unread_scene_ = Ref<PackedScene>();
	reader_ = nullptr;
	if (!take_content(reader.take(), loaded_scene)) {
		return false;
	}
	emit_changed();
	return true;
}

bool ScatterModel::accept_edit(const char *p_property) const {
	if (scene_.is_valid()) {
		ERR_PRINT(
				vformat("ScatterModel.%s is read from %s: set scene to null to edit it.", p_property, name_of(scene_)));
		return false;
	}
	return true;
}

/// Watches both lists together, because an LOD may be in both.
void ScatterModel::watch_lods(bool p_watch) {
	for (const TypedArray<ScatterLod> *lods : {&lods_, &far_lods_}) {
		for (int64_t index = 0; index < lods->size(); ++index) {
			watch(Ref<ScatterLod>((*lods)[index]).ptr(), "changed", this, "emit_changed", p_watch);
		}
	}
}

void ScatterModel::replace_lods(TypedArray<ScatterLod> &r_lods, const TypedArray<ScatterLod> &p_lods) {
	watch_lods(false);
	r_lods = p_lods;
	watch_lods(true);
}

void ScatterModel::set_lods(const TypedArray<ScatterLod> &p_lods) {
	if (accept_count("lods", p_lods) && accept_edit("lods")) {
		set_by_hand_.lods = true;
		replace_lods(lods_, p_lods);
		emit_changed();
	}
}

void ScatterModel::set_far_lods(const TypedArray<ScatterLod> &p_lods) {
	if (accept_count("far_lods", p_lods)) {
		replace_lods(far_lods_, p_lods);
		emit_changed();
	}
}

void ScatterModel::set_shapes(const TypedArray<Shape3D> &p_shapes) {
	if (accept_edit("shapes")) {
		set_by_hand_.shapes = true;
		shapes_ = p_shapes;
		emit_changed();
	}
}

void ScatterModel::set_shape_transforms(const TypedArray<Transform3D> &p_transforms) {
	if (accept_edit("shape_transforms")) {
		set_by_hand_.shape_transforms = true;
		shape_transforms_ = p_transforms;
		emit_changed();
	}
}

std::vector<DrawnLod> ScatterModel::drawn_lods() const {
	std::vector<DrawnLod> result;
	for (int64_t index = 0; index < lods_.size(); ++index) {
		const Ref<ScatterLod> lod = lods_[index];
		if (lod.is_valid() && (lod->get_mesh().is_valid() || !result.empty())) {
			const double previous_distance = result.empty() ? 0.0 : result.back().distance;
			add_drawn_lod(lod, result);
			result.back().distance = std::max(result.back().distance, previous_distance);
		}
	}
	for (int64_t index = 0; index < far_lods_.size() && !result.empty(); ++index) {
		const Ref<ScatterLod> lod = far_lods_[index];
		if (lod.is_valid() && lod->get_mesh().is_valid()) {
			add_drawn_lod(lod, result);
		}
	}
	std::ranges::stable_sort(result, {}, &DrawnLod::distance);
	return result;
}

std::vector<ModelShape> ScatterModel::model_shapes() const {
	std::vector<ModelShape> result;
	for (int64_t index = 0; index < shapes_.size(); ++index) {
		const Ref<Shape3D> shape = shapes_[index];
		if (shape.is_valid()) {
			result.push_back(
					{shape, index < shape_transforms_.size() ? Transform3D(shape_transforms_[index]) : Transform3D()});
		}
	}
	return result;
}

TypedArray<ScatterLod> ScatterModel::get_lods() {
	read();
	return lods_;
}

TypedArray<Shape3D> ScatterModel::get_shapes() {
	read();
	return shapes_;
}

TypedArray<Transform3D> ScatterModel::get_shape_transforms() {
	read();
	return shape_transforms_;
}

PackedStringArray ScatterModel::get_problems() {
	read();
	return remarks_;
}

Ref<Mesh> ScatterModel::get_mesh(int64_t p_lod) {
	read();
	const std::vector<DrawnLod> lods = drawn_lods();
	return p_lod >= 0 && p_lod < static_cast<int64_t>(lods.size()) ? lods[static_cast<std::size_t>(p_lod)].mesh
																   : Ref<Mesh>();
}

AABB ScatterModel::get_aabb() {
	read();
	const std::vector<DrawnLod> lods = drawn_lods();
	AABB box = lods.empty() ? AABB() : lods.front().mesh->get_aabb();
	for (const DrawnLod &lod : lods) {
		box = joined(box, lod.mesh->get_aabb());
	}
	return box;
}

/// Makes the properties that are read from the scene read-only and excludes them from saving,
/// because the scene contains them.
void ScatterModel::_validate_property(PropertyInfo &p_property) const {
	for (const char *name : read_properties) {
		if (scene_.is_valid() && p_property.name == StringName(name)) {
			p_property.usage = PROPERTY_USAGE_EDITOR | PROPERTY_USAGE_READ_ONLY;
		}
	}
}

void ScatterModel::add_used(SceneUse::List &r_used) const {
	for (const TypedArray<ScatterLod> *lods : {&lods_, &far_lods_}) {
		for (int64_t index = 0; index < lods->size(); ++index) {
			r_used.add(Ref<ScatterLod>((*lods)[index]));
		}
	}
}

} // namespace thicket
