#include "core/placement/compact_tile.hpp"

#include "core/base/instance_id.hpp"
#include "core/placement/transform_batch.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace thicket {

namespace {

glm::vec3 position_of(const MeshInstances &mesh, std::size_t i) {
	const float *floats = mesh.buffer.data() + i * mesh.stride;
	return {floats[3], floats[7], floats[11]};
}

/// Returns false for upright layers: there, only the signs of a normal's x and z matter, because
/// they determine the signs of zeros in the transform.
bool needs_normals(const LayerSettings &settings) { return settings.placement.align_to_normal != 0.0; }

std::size_t bytes_of(const auto &values) { return values.capacity() * sizeof(values[0]); }

bool same_bits(std::span<const float> a, std::span<const float> b) {
	return std::ranges::equal(
			a, b, [](float x, float y) { return std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y); });
}

bool same_bits(const glm::vec3 &a, const glm::vec3 &b) {
	return same_bits(std::array{a.x, a.y, a.z}, std::array{b.x, b.y, b.z});
}

bool same_bits(const SourceFractions &a, const SourceFractions &b) {
	return same_bits(std::array{a.color, a.variation, a.scale}, std::array{b.color, b.variation, b.scale});
}

} // namespace

CompactMesh::CompactMesh(
		const MeshInstances &mesh, std::shared_ptr<const LayerSettings> settings, const glm::dvec3 &origin) :
		settings_(std::move(settings)), up_(settings_ != nullptr ? settings_->planet : Planet(), origin),
		stride_(mesh.stride), min_(mesh.min), max_(mesh.max), max_scale_(mesh.max_scale),
		ranks_(mesh.ranks.begin(), mesh.ranks.end()) {
	positions_.resize(mesh.size());
	for (std::size_t i = 0; i < mesh.size(); ++i) {
		positions_[i] = position_of(mesh, i);
	}
	if (settings_ != nullptr && mesh.normals.size() == mesh.size() && find_cells(mesh)) {
		store_sources(mesh);
	} else {
		store_floats(mesh);
	}
}

/// Returns false if the ids are not all points of one layer, or if their cells are too far apart to
/// be packed.
bool CompactMesh::find_cells(const MeshInstances &mesh) {
	if (mesh.size() == 0) {
		return true;
	}
	const std::uint16_t layer = unpack(mesh.ids.front()).layer;
	glm::ivec2 low(std::numeric_limits<int>::max());
	glm::ivec2 high(std::numeric_limits<int>::min());
	bool same_layer = true;
	for (const std::uint64_t id : mesh.ids) {
		const InstanceId point = unpack(id);
		same_layer &= point.layer == layer;
		low = glm::min(low, point.cell);
		high = glm::max(high, point.cell);
	}
	const glm::ivec2 extent = high - low;
	if (!same_layer || std::max(extent.x, extent.y) > static_cast<int>(cell_mask)) {
		return false;
	}
	first_id_ = pack({layer, low});
	cells_.resize(mesh.size());
	for (std::size_t i = 0; i < mesh.size(); ++i) {
		const glm::uvec2 cell(unpack(mesh.ids[i]).cell - low);
		const glm::vec3 &normal = mesh.normals[i];
		const std::uint32_t signs =
				(std::signbit(normal.x) ? x_is_negative : 0) | (std::signbit(normal.z) ? z_is_negative : 0);
		cells_[i] = signs | cell.x << y_bits | cell.y;
	}
	return true;
}

void CompactMesh::store_floats(const MeshInstances &mesh) {
	ids_.assign(mesh.ids.begin(), mesh.ids.end());
	floats_.assign(mesh.buffer.begin(), mesh.buffer.end());
}

void CompactMesh::store_sources(const MeshInstances &mesh) {
	if (needs_normals(*settings_)) {
		normals_.assign(mesh.normals.begin(), mesh.normals.end());
	}
	const auto store = [&mesh](bool is_known, float SourceFractions::*fraction, std::vector<float> &r_fractions) {
		r_fractions.reserve(is_known ? mesh.fractions.size() : 0);
		for (std::size_t i = 0; is_known && i < mesh.fractions.size(); ++i) {
			r_fractions.push_back(mesh.fractions[i].*fraction);
		}
	};
	const InstanceData &data = settings_->instance_data;
	store(data.color_is_known(), &SourceFractions::color, color_fractions_);
	store(data.variation_is_known(), &SourceFractions::variation, variation_fractions_);
	store(data.scale_is_known(), &SourceFractions::scale, scale_fractions_);
}

CompactMesh::CompactMesh(const MeshInstances &first, const CompactMesh &base, std::span<const std::uint32_t> retained) :
		settings_(base.settings_), up_(base.up_), stride_(base.stride_), first_id_(base.first_id_) {
	const std::size_t count = first.size() + retained.size();
	const auto computed =
			std::ranges::partition_point(retained, [&base](std::uint32_t i) { return i < base.stored_count(); });
	positions_.reserve(count);
	ranks_.reserve(count);
	ids_.reserve(first.size() + static_cast<std::size_t>(computed - retained.begin()));
	store_floats(first);
	for (std::size_t i = 0; i < first.size(); ++i) {
		positions_.push_back(position_of(first, i));
		ranks_.push_back(first.ranks[i]);
	}
	for (const std::uint32_t i : retained) {
		positions_.push_back(base.positions_[i]);
		ranks_.push_back(base.ranks_[i]);
	}
	for (auto at = retained.begin(); at != computed; ++at) {
		const auto floats = base.floats_.begin() + static_cast<std::ptrdiff_t>(*at * stride_);
		ids_.push_back(base.ids_[*at]);
		floats_.insert(floats_.end(), floats, floats + static_cast<std::ptrdiff_t>(stride_));
	}
	const auto choose = [&](const auto &from, auto &r_to) {
		if (!from.empty()) {
			r_to.reserve(static_cast<std::size_t>(retained.end() - computed));
			std::for_each(
					computed, retained.end(), [&](std::uint32_t i) { r_to.push_back(from[i - base.stored_count()]); });
		}
	};
	choose(base.cells_, cells_);
	choose(base.normals_, normals_);
	choose(base.color_fractions_, color_fractions_);
	choose(base.variation_fractions_, variation_fractions_);
	choose(base.scale_fractions_, scale_fractions_);
	measure(std::max(base.max_scale_, first.max_scale));
}

/// Computes the bounds of the positions.
void CompactMesh::measure(float max_scale) {
	max_scale_ = max_scale;
	if (!positions_.empty()) {
		min_ = max_ = positions_.front();
	}
	for (const glm::vec3 &position : positions_) {
		min_ = glm::min(min_, position);
		max_ = glm::max(max_, position);
	}
}

std::size_t CompactMesh::find(std::uint64_t id) const {
	if (const auto found = std::ranges::find(ids_, id); found != ids_.end()) {
		return static_cast<std::size_t>(found - ids_.begin());
	}
	// For an id that is not in this mesh, either these offsets are out of range or the search below
	// finds nothing.
	const std::uint64_t from_first = id - first_id_;
	const std::uint64_t x = from_first >> 24;
	const std::uint64_t y = from_first & 0xffffff;
	if (x > cell_mask || y > cell_mask) {
		return size();
	}
	const auto cell = static_cast<std::uint32_t>(x << y_bits | y);
	const auto is_it = [cell](std::uint32_t each) {
		return (each & (x_is_negative - 1)) == cell;
	};
	// The search tests many cells at a time without branches, so that the compiler can vectorize
	// the loop.
	constexpr std::ptrdiff_t max_unsorted = 64;
	auto first = cells_.begin();
	for (; cells_.end() - first >= max_unsorted; first += max_unsorted) {
		// Counts the matches in these cells. If there are none, the search continues.
		std::uint32_t hits = 0;
		for (std::ptrdiff_t i = 0; i < max_unsorted; ++i) {
			hits += is_it(first[i]) ? 1 : 0;
		}
		if (hits != 0) {
			break;
		}
	}
	return stored_count() + static_cast<std::size_t>(std::find_if(first, cells_.end(), is_it) - cells_.begin());
}

/// Returns a normal that produces the same floats as the original one.
glm::vec3 CompactMesh::normal_of(std::size_t source) const {
	if (!normals_.empty()) {
		return normals_[source];
	}
	const std::uint32_t signs = cells_[source];
	return {(signs & x_is_negative) != 0 ? -1.0f : 1.0f, 1.0f, (signs & z_is_negative) != 0 ? -1.0f : 1.0f};
}

SourceFractions CompactMesh::fractions_of(std::size_t source) const {
	const auto at = [source](const std::vector<float> &fractions) {
		return fractions.empty() ? unknown_fraction : fractions[source];
	};
	return {at(color_fractions_), at(variation_fractions_), at(scale_fractions_)};
}

/// Returns the number that selects the scale of a generated instance.
double CompactMesh::scale_number_of(std::size_t i) const {
	return scale_number(
			settings_->instance_data.scale, settings_->set.seed, id(i), fractions_of(i - stored_count()).scale);
}

/// Writes the transform of a generated instance. Returns its scale.
float CompactMesh::read_basis(std::size_t i, std::span<float, transform_floats> r_floats) const {
	const glm::vec3 normal = normal_of(i - stored_count());
	write_position(positions_[i], r_floats);
	const ScaleSource &scale = settings_->instance_data.scale;
	return write_basis(settings_->placement, settings_->set.seed, id(i), normal, r_floats, up_,
			scale.used() ? std::optional(scale_number_of(i)) : std::nullopt, row_heading(*settings_, id(i)));
}

void CompactMesh::read_transform(std::size_t i, std::span<float, transform_floats> r_floats) const {
	if (i < stored_count()) {
		std::ranges::copy(std::span(floats_).subspan(i * stride_).first<transform_floats>(), r_floats.begin());
	} else {
		read_basis(i, r_floats);
	}
}

void CompactMesh::read(std::size_t i, std::span<float> r_floats) const {
	if (i < stored_count()) {
		std::ranges::copy(std::span(floats_).subspan(i * stride_, stride_), r_floats.begin());
		return;
	}
	read_instance_data(i, read_basis(i, r_floats.first<transform_floats>()), r_floats.subspan(transform_floats));
}

/// Writes the data that follows the transform of a generated instance.
void CompactMesh::read_instance_data(std::size_t i, float scale, std::span<float> r_floats) const {
	write_instance_data(settings_->instance_data, settings_->set.seed, id(i), ranks_[i], scale, r_floats,
			fractions_of(i - stored_count()));
}

/// Reads many instances in batches. `index_of(n)` returns the index of the n-th one.
template <class IndexOf>
void CompactMesh::read_many(std::size_t count, const IndexOf &index_of, std::span<float> r_floats) const {
	TransformBatch batch;
	std::array<double, TransformBatch::capacity> scale_numbers;
	const bool uses_scale_numbers = settings_ != nullptr && settings_->instance_data.scale.used();
	for (std::size_t first = 0; first < count;) {
		std::size_t end = first;
		for (batch.count = 0; end < count && batch.count < TransformBatch::capacity; ++end) {
			const std::size_t i = index_of(end);
			if (i >= stored_count()) {
				if (uses_scale_numbers) {
					scale_numbers[batch.count] = scale_number_of(i);
				}
				batch.set_heading(row_heading(*settings_, id(i)));
				batch.add(id(i), normal_of(i - stored_count()), positions_[i]);
			}
		}
		if (batch.count > 0) {
			batch.make(settings_->placement, settings_->set.seed, up_,
					std::span(scale_numbers).first(uses_scale_numbers ? batch.count : 0));
		}
		for (std::size_t computed = 0; first < end; ++first) {
			const std::size_t i = index_of(first);
			const std::span<float> floats = r_floats.subspan(first * stride_, stride_);
			if (i < stored_count()) {
				read(i, floats);
				continue;
			}
			batch.write(computed, floats.first<transform_floats>());
			read_instance_data(i, batch.scale[computed++], floats.subspan(transform_floats));
		}
	}
}

void CompactMesh::read(std::span<const std::uint32_t> order, std::span<float> r_floats) const {
	read_many(order.size(), [order](std::size_t at) { return std::size_t{order[at]}; }, r_floats);
}

void CompactMesh::read_all(std::span<float> r_floats) const {
	read_many(size(), [](std::size_t at) { return at; }, r_floats);
}

bool CompactMesh::same(std::size_t i, const CompactMesh &other, std::size_t j) const {
	const bool as_it_is = i < stored_count();
	if (stride_ != other.stride_ || as_it_is != (j < other.stored_count()) || id(i) != other.id(j)) {
		return false;
	}
	if (as_it_is) {
		return same_bits(std::span(floats_).subspan(i * stride_, stride_),
				std::span(other.floats_).subspan(j * stride_, stride_));
	}
	const std::size_t a = i - stored_count();
	const std::size_t b = j - other.stored_count();
	return settings_ == other.settings_ && ranks_[i] == other.ranks_[j] &&
			same_bits(positions_[i], other.positions_[j]) && same_bits(normal_of(a), other.normal_of(b)) &&
			same_bits(fractions_of(a), other.fractions_of(b));
}

std::size_t CompactMesh::bytes() const {
	return bytes_of(positions_) + bytes_of(ranks_) + bytes_of(cells_) + bytes_of(normals_) +
			bytes_of(color_fractions_) + bytes_of(variation_fractions_) + bytes_of(scale_fractions_) + bytes_of(ids_) +
			bytes_of(floats_);
}

CompactTile::CompactTile(const TileInstances &tile, const std::shared_ptr<const LayerSettings> &settings) :
		origin(tile.origin), counts(tile.counts) {
	meshes.reserve(tile.meshes.size());
	for (const MeshInstances &mesh : tile.meshes) {
		meshes.emplace_back(mesh, settings, origin);
	}
}

MeshInstances expanded(const CompactMesh &mesh) {
	MeshInstances result;
	result.resize(mesh.size(), mesh.stride());
	mesh.read_all(result.buffer);
	for (std::size_t i = 0; i < mesh.size(); ++i) {
		result.ids[i] = mesh.id(i);
	}
	result.ranks.assign(mesh.ranks().begin(), mesh.ranks().end());
	result.min = mesh.min();
	result.max = mesh.max();
	result.max_scale = mesh.max_scale();
	return result;
}

TileInstances expanded(const CompactTile &tile) {
	TileInstances result;
	result.origin = tile.origin;
	result.counts = tile.counts;
	for (const CompactMesh &mesh : tile.meshes) {
		result.meshes.push_back(expanded(mesh));
	}
	return result;
}

} // namespace thicket
