#include "nodes/scatter_terrain_heightmap.hpp"

#include "nodes/property_check.hpp"

#include <godot_cpp/classes/file_access.hpp>
#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/variant/packed_byte_array.hpp>

#include <cmath>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

constexpr const char *class_name = "ScatterTerrainHeightmap";
constexpr double height_limit = 1e6;

bool has_content(const Ref<Image> &image) {
	return image.is_valid() && image->get_width() > 0 && image->get_height() > 0;
}

} // namespace

std::shared_ptr<const Terrain> ScatterTerrainHeightmap::snapshot() {
	refresh();
	return field_;
}

String ScatterTerrainHeightmap::problem() {
	refresh();
	return status_.ok() ? String() : sentence(class_name, status_);
}

void ScatterTerrainHeightmap::change(bool p_posts) {
	posts_stale_ = posts_stale_ || p_posts;
	field_stale_ = true;
	emit_changed();
}

void ScatterTerrainHeightmap::refresh() {
	if (!field_stale_) {
		return;
	}
	field_stale_ = false;
	status_ = build();
	report(class_name, status_);
}

Status ScatterTerrainHeightmap::build() {
	HeightfieldFrame frame;
	frame.min_height = min_height_;
	frame.max_height = max_height_;
	frame.area.min = {rect_.position.x, rect_.position.y};
	frame.area.max = frame.area.min + glm::dvec2{rect_.size.x, rect_.size.y};
	Status status = read_posts(frame.posts);
	if (status.ok()) {
		const auto field = std::make_shared<Heightfield>();
		status = field->set(frame, posts_);
		if (status.ok()) {
			field_ = field;
		}
	}
	return status;
}

Status ScatterTerrainHeightmap::read_posts(glm::ivec2 &r_count) {
	if (image_.is_valid()) {
		r_count = {image_->get_width(), image_->get_height()};
	} else {
		r_count = {post_count_.x, post_count_.y};
	}
	if (!posts_stale_) {
		return {};
	}
	const Status status = image_.is_valid() ? read_image() : read_file();
	posts_stale_ = !status.ok();
	return status;
}

Status ScatterTerrainHeightmap::read_file() {
	if (heightmap_path_.is_empty()) {
		return {ErrorCode::missing, "heightmap_path", 0.0};
	}
	for (const int count : {post_count_.x, post_count_.y}) {
		if (count < 2 || count > max_heightfield_posts) {
			return {ErrorCode::out_of_range, "post_count", static_cast<double>(count)};
		}
	}
	const PackedByteArray bytes = FileAccess::get_file_as_bytes(heightmap_path_);
	if (bytes.is_empty()) {
		return {ErrorCode::missing, "heightmap_path", 0.0};
	}
	const int64_t count = int64_t{post_count_.x} * post_count_.y;
	if (bytes.size() != 2 * count) {
		return {ErrorCode::wrong_size, "heightmap_path", static_cast<double>(bytes.size())};
	}
	posts_.resize(static_cast<std::size_t>(count));
	const std::uint8_t *byte = bytes.ptr();
	for (std::uint16_t &post : posts_) {
		post = static_cast<std::uint16_t>(byte[0] | byte[1] << 8);
		byte += 2;
	}
	return {};
}

Status ScatterTerrainHeightmap::read_image() {
	if (!has_content(image_)) {
		return {ErrorCode::wrong_size, "image", 0.0};
	}
	// Single floats hold 16 bits exactly, so one conversion serves every format.
	const Ref<Image> floats = image_->duplicate();
	if (floats->is_compressed() && floats->decompress() != OK) {
		return {ErrorCode::out_of_range, "image", static_cast<double>(image_->get_format())};
	}
	floats->clear_mipmaps();
	floats->convert(Image::FORMAT_RF);
	const PackedByteArray bytes = floats->get_data();
	const auto *value = reinterpret_cast<const float *>(bytes.ptr());
	std::vector<std::uint16_t> posts(static_cast<std::size_t>(bytes.size()) / sizeof(float));
	for (std::uint16_t &post : posts) {
		const double unit = *value++;
		if (!std::isfinite(unit)) {
			return {ErrorCode::not_finite, "image", unit};
		}
		if (unit < 0.0 || unit > 1.0) {
			return {ErrorCode::out_of_range, "image", unit};
		}
		post = static_cast<std::uint16_t>(std::lround(unit * 65535.0));
	}
	posts_ = std::move(posts);
	return {};
}

void ScatterTerrainHeightmap::set_heightmap_path(const String &p_path) {
	heightmap_path_ = p_path;
	change(true);
}

String ScatterTerrainHeightmap::get_heightmap_path() const { return heightmap_path_; }

void ScatterTerrainHeightmap::set_post_count(const Vector2i &p_count) {
	const auto accepted = [](int count) {
		return accept_number(class_name, "post_count", count, 2.0, max_heightfield_posts);
	};
	if (accepted(p_count.x) && accepted(p_count.y)) {
		post_count_ = p_count;
		change(true);
	}
}

Vector2i ScatterTerrainHeightmap::get_post_count() const { return post_count_; }

void ScatterTerrainHeightmap::set_image(const Ref<Image> &p_image) {
	if (p_image.is_valid() && !has_content(p_image)) {
		report(class_name, {ErrorCode::wrong_size, "image", 0.0});
		return;
	}
	image_ = p_image;
	change(true);
}

Ref<Image> ScatterTerrainHeightmap::get_image() const { return image_; }

void ScatterTerrainHeightmap::set_rect(const Rect2 &p_rect) {
	for (const real_t number : {p_rect.position.x, p_rect.position.y}) {
		if (!accept_number(class_name, "rect", number, -1e9, 1e9)) {
			return;
		}
	}
	for (const real_t number : {p_rect.size.x, p_rect.size.y}) {
		if (!accept_number(class_name, "rect", number, 1e-3, 1e9)) {
			return;
		}
	}
	rect_ = p_rect;
	change(false);
}

Rect2 ScatterTerrainHeightmap::get_rect() const { return rect_; }

void ScatterTerrainHeightmap::set_min_height(double p_height) {
	if (accept_number(class_name, "min_height", p_height, -height_limit, height_limit)) {
		min_height_ = p_height;
		change(false);
	}
}

double ScatterTerrainHeightmap::get_min_height() const { return min_height_; }

void ScatterTerrainHeightmap::set_max_height(double p_height) {
	if (accept_number(class_name, "max_height", p_height, -height_limit, height_limit)) {
		max_height_ = p_height;
		change(false);
	}
}

double ScatterTerrainHeightmap::get_max_height() const { return max_height_; }

void ScatterTerrainHeightmap::_bind_methods() {
	using Self = ScatterTerrainHeightmap;
	ClassDB::bind_method(D_METHOD("set_heightmap_path", "path"), &Self::set_heightmap_path);
	ClassDB::bind_method(D_METHOD("get_heightmap_path"), &Self::get_heightmap_path);
	ClassDB::bind_method(D_METHOD("set_post_count", "count"), &Self::set_post_count);
	ClassDB::bind_method(D_METHOD("get_post_count"), &Self::get_post_count);
	ClassDB::bind_method(D_METHOD("set_image", "image"), &Self::set_image);
	ClassDB::bind_method(D_METHOD("get_image"), &Self::get_image);
	ClassDB::bind_method(D_METHOD("set_rect", "rect"), &Self::set_rect);
	ClassDB::bind_method(D_METHOD("get_rect"), &Self::get_rect);
	ClassDB::bind_method(D_METHOD("set_min_height", "height"), &Self::set_min_height);
	ClassDB::bind_method(D_METHOD("get_min_height"), &Self::get_min_height);
	ClassDB::bind_method(D_METHOD("set_max_height", "height"), &Self::set_max_height);
	ClassDB::bind_method(D_METHOD("get_max_height"), &Self::get_max_height);
	ADD_PROPERTY(PropertyInfo(Variant::STRING, "heightmap_path", PROPERTY_HINT_FILE, "*.r16,*.raw"),
			"set_heightmap_path", "get_heightmap_path");
	ADD_PROPERTY(PropertyInfo(Variant::VECTOR2I, "post_count"), "set_post_count", "get_post_count");
	ADD_PROPERTY(
			PropertyInfo(Variant::OBJECT, "image", PROPERTY_HINT_RESOURCE_TYPE, "Image"), "set_image", "get_image");
	ADD_PROPERTY(PropertyInfo(Variant::RECT2, "rect", PROPERTY_HINT_NONE, "suffix:m"), "set_rect", "get_rect");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "min_height", PROPERTY_HINT_RANGE,
						 "-1000,9000,0.01,or_less,or_greater,suffix:m"),
			"set_min_height", "get_min_height");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "max_height", PROPERTY_HINT_RANGE,
						 "-1000,9000,0.01,or_less,or_greater,suffix:m"),
			"set_max_height", "get_max_height");
}

} // namespace thicket
