#include "nodes/impostor/scatter_impostor_baker.hpp"

#include "core/impostor/srgb.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/impostor/surface_arrays.hpp"

#include <godot_cpp/core/class_db.hpp>

#include <utility>

using namespace godot;

namespace thicket {

namespace {

glm::vec4 linear_of(const Color &p_color) {
	const SrgbCurve &curve = SrgbCurve::get();
	return {curve.linear(p_color.r), curve.linear(p_color.g), curve.linear(p_color.b), p_color.a};
}

Error error_of(ErrorCode p_code) {
	switch (p_code) {
		case ErrorCode::none: return OK;
		case ErrorCode::cancelled: return ERR_SKIP;
		case ErrorCode::out_of_memory: return ERR_OUT_OF_MEMORY;
		default: return ERR_INVALID_DATA;
	}
}

} // namespace

ImpostorSettings ScatterImpostorBaker::current_settings() const {
	const std::lock_guard lock(mutex_);
	return settings_;
}

void ScatterImpostorBaker::apply_settings(const ImpostorSettings &p_settings) {
	const Status status = validate(p_settings);
	report(class_name, status);
	if (status.ok()) {
		const std::lock_guard lock(mutex_);
		settings_ = p_settings;
	}
}

void ScatterImpostorBaker::set_frames(int64_t p_frames) {
	if (accept_number(class_name, "frames", static_cast<double>(p_frames), min_impostor_frames, max_impostor_frames)) {
		ImpostorSettings settings = current_settings();
		settings.frames = static_cast<int>(p_frames);
		apply_settings(settings);
	}
}

int64_t ScatterImpostorBaker::get_frames() const { return current_settings().frames; }

void ScatterImpostorBaker::set_frame_size(int64_t p_frame_size) {
	if (accept_number(class_name, "frame_size", static_cast<double>(p_frame_size), min_frame_size, max_frame_size)) {
		ImpostorSettings settings = current_settings();
		settings.frame_size = static_cast<int>(p_frame_size);
		apply_settings(settings);
	}
}

int64_t ScatterImpostorBaker::get_frame_size() const { return current_settings().frame_size; }

void ScatterImpostorBaker::set_samples(int64_t p_samples) {
	if (accept_number(class_name, "samples", static_cast<double>(p_samples), 1.0, max_impostor_samples)) {
		ImpostorSettings settings = current_settings();
		settings.samples = static_cast<int>(p_samples);
		apply_settings(settings);
	}
}

int64_t ScatterImpostorBaker::get_samples() const { return current_settings().samples; }

void ScatterImpostorBaker::set_full_sphere(bool p_full_sphere) {
	ImpostorSettings settings = current_settings();
	settings.span = p_full_sphere ? OctahedralSpan::sphere : OctahedralSpan::hemisphere;
	apply_settings(settings);
}

bool ScatterImpostorBaker::is_full_sphere() const { return current_settings().span == OctahedralSpan::sphere; }

Error ScatterImpostorBaker::add_surface(const Array &p_arrays, const Transform3D &p_transform, const Color &p_albedo,
		const Ref<Image> &p_texture, double p_alpha_threshold, CullMode p_cull_mode, VertexColorMode p_vertex_colors) {
	if (!accept_number(class_name, "cull_mode", static_cast<double>(p_cull_mode), CULL_BACK, CULL_DISABLED) ||
			!accept_number(class_name, "vertex_colors", static_cast<double>(p_vertex_colors), VERTEX_COLOR_UNUSED,
					VERTEX_COLOR_SRGB)) {
		return ERR_INVALID_DATA;
	}
	ImpostorSurface surface;
	Status status = read_arrays(p_arrays, surface);
	surface.material.albedo = linear_of(p_albedo);
	surface.material.alpha_threshold = static_cast<float>(p_alpha_threshold);
	surface.material.culled_side = static_cast<CulledSide>(p_cull_mode);
	surface.material.vertex_colors = static_cast<VertexColors>(p_vertex_colors);
	if (status.ok()) {
		status = surface.check();
	}
	if (status.ok() && p_texture.is_valid()) {
		surface.material.texture = texture_of(p_texture);
		if (surface.material.texture == nullptr) {
			return ERR_INVALID_DATA;
		}
	}
	report(class_name, status);
	if (status.ok()) {
		surface.transform(glm::mat3(to_core(p_transform.basis)), glm::vec3(to_core(p_transform.origin)));
		const std::lock_guard lock(mutex_);
		surfaces_.push_back(std::move(surface));
	}
	return error_of(status.code);
}

/// Returns the pixels of an image, which is read only once. If it cannot be read, prints an error
/// and returns null.
std::shared_ptr<const SurfaceTexture> ScatterImpostorBaker::texture_of(const Ref<Image> &p_image) {
	const std::lock_guard lock(mutex_);
	std::shared_ptr<const SurfaceTexture> &cached = textures_[p_image->get_instance_id()];
	if (cached != nullptr) {
		return cached;
	}
	auto texture = std::make_shared<SurfaceTexture>();
	const Status status = read_texture(p_image, *texture);
	report(class_name, status);
	if (status.ok()) {
		cached = std::move(texture);
	}
	return cached;
}

void ScatterImpostorBaker::clear() {
	const std::lock_guard lock(mutex_);
	surfaces_.clear();
	textures_.clear();
}

Error ScatterImpostorBaker::bake() {
	if (busy_.exchange(true)) {
		return ERR_BUSY;
	}
	// Keeps the baker alive if a script releases it during the bake.
	const Ref<ScatterImpostorBaker> keep_alive(this);
	cancelled_ = false;
	progress_ = 0.0;
	Status status;
	try {
		std::unique_lock lock(mutex_);
		const std::vector<ImpostorSurface> surfaces = surfaces_;
		const ImpostorSettings settings = settings_;
		lock.unlock();
		Impostor impostor;
		status = bake_impostor(surfaces, settings,
				{.cancel = &cancelled_, .report = [this](double fraction, std::uint64_t) { progress_ = fraction; }},
				impostor);
		if (status.ok()) {
			lock.lock();
			impostor_ = std::move(impostor);
		}
	} catch (...) {
		busy_ = false;
		throw; // The caller reports the exception (see guard.hpp).
	}
	busy_ = false;
	report(class_name, status);
	return error_of(status.code);
}

void ScatterImpostorBaker::cancel() { cancelled_ = true; }

Ref<Image> ScatterImpostorBaker::image_of(const std::vector<std::uint8_t> &p_atlas) const {
	const std::lock_guard lock(mutex_);
	if (p_atlas.empty()) {
		return {};
	}
	const int side = impostor_.settings.frames * impostor_.settings.frame_size;
	return Image::create_from_data(side, side, true, Image::FORMAT_RGBA8, packed_bytes(p_atlas));
}

Ref<Image> ScatterImpostorBaker::get_albedo_image() const { return image_of(impostor_.albedo); }

Ref<Image> ScatterImpostorBaker::get_normal_image() const { return image_of(impostor_.normal); }

AABB ScatterImpostorBaker::get_box() const {
	const std::lock_guard lock(mutex_);
	return {to_engine(impostor_.min), to_engine(impostor_.max - impostor_.min)};
}

Vector3 ScatterImpostorBaker::get_center() const {
	const std::lock_guard lock(mutex_);
	return to_engine(impostor_.center);
}

double ScatterImpostorBaker::get_radius() const {
	const std::lock_guard lock(mutex_);
	return static_cast<double>(impostor_.radius);
}

void ScatterImpostorBaker::_bind_methods() {
	using Self = ScatterImpostorBaker;
	const Color white{1.0F, 1.0F, 1.0F, 1.0F};
	bind_guarded<&Self::set_frames>(D_METHOD("set_frames", "frames"));
	bind_guarded<&Self::get_frames>(D_METHOD("get_frames"));
	bind_guarded<&Self::set_frame_size>(D_METHOD("set_frame_size", "frame_size"));
	bind_guarded<&Self::get_frame_size>(D_METHOD("get_frame_size"));
	bind_guarded<&Self::set_samples>(D_METHOD("set_samples", "samples"));
	bind_guarded<&Self::get_samples>(D_METHOD("get_samples"));
	bind_guarded<&Self::set_full_sphere>(D_METHOD("set_full_sphere", "full_sphere"));
	bind_guarded<&Self::is_full_sphere>(D_METHOD("is_full_sphere"));
	bind_guarded<&Self::add_surface>(D_METHOD("add_surface", "arrays", "transform", "albedo", "texture",
											 "alpha_threshold", "cull_mode", "vertex_colors"),
			DEFVAL(Transform3D()), DEFVAL(white), DEFVAL(Ref<Image>()), DEFVAL(0.0),
			DEFVAL(static_cast<int64_t>(CULL_BACK)), DEFVAL(static_cast<int64_t>(VERTEX_COLOR_UNUSED)));
	bind_guarded<&Self::clear>(D_METHOD("clear"));
	bind_guarded<&Self::bake>(D_METHOD("bake"));
	bind_guarded<&Self::cancel>(D_METHOD("cancel"));
	bind_guarded<&Self::get_progress>(D_METHOD("get_progress"));
	bind_guarded<&Self::get_albedo_image>(D_METHOD("get_albedo_image"));
	bind_guarded<&Self::get_normal_image>(D_METHOD("get_normal_image"));
	bind_guarded<&Self::get_box>(D_METHOD("get_box"));
	bind_guarded<&Self::get_center>(D_METHOD("get_center"));
	bind_guarded<&Self::get_radius>(D_METHOD("get_radius"));
	ADD_PROPERTY(PropertyInfo(Variant::INT, "frames", PROPERTY_HINT_RANGE, "2,32,1"), "set_frames", "get_frames");
	ADD_PROPERTY(
			PropertyInfo(Variant::INT, "frame_size", PROPERTY_HINT_ENUM, "16:16,32:32,64:64,128:128,256:256,512:512"),
			"set_frame_size", "get_frame_size");
	ADD_PROPERTY(PropertyInfo(Variant::INT, "samples", PROPERTY_HINT_RANGE, "1,8,1"), "set_samples", "get_samples");
	ADD_PROPERTY(PropertyInfo(Variant::BOOL, "full_sphere"), "set_full_sphere", "is_full_sphere");
	BIND_ENUM_CONSTANT(CULL_BACK);
	BIND_ENUM_CONSTANT(CULL_FRONT);
	BIND_ENUM_CONSTANT(CULL_DISABLED);
	BIND_ENUM_CONSTANT(VERTEX_COLOR_UNUSED);
	BIND_ENUM_CONSTANT(VERTEX_COLOR_LINEAR);
	BIND_ENUM_CONSTANT(VERTEX_COLOR_SRGB);
}

} // namespace thicket
