#include "core/base/bytes.hpp"
#include "core/base/check.hpp"
#include "core/base/guard.hpp"
#include "core/rules/painted_mask.hpp"
#include "core/rules/painted_mask_edit.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

// Format 1, all numbers little-endian:
//   "TMSK", u32 version, f64 pixel size in meters, u8 background;
//   for each block that is not entirely background, ascending by (row, column):
//     i32 row, i32 column, u8 kind,
//     then 1 byte for a block of one value (kind 0), or all its pixels row by row (kind 1);
//   u64 FNV-1a of all bytes before it.
// Each mask has exactly one valid encoding. Saving a loaded file therefore reproduces it byte for
// byte.

namespace thicket {

namespace {

constexpr std::uint32_t magic = 0x4b534d54;
constexpr std::uint32_t format_version = 1;
constexpr std::size_t header_size = 17;
constexpr std::size_t checksum_size = 8;
constexpr int block_limit = block_of(PaintedMask::pixel_limit);

enum class BlockKind : std::uint8_t {
	uniform = 0,
	pixels = 1,
};

} // namespace

/// Parses the bytes after the header into blocks.
class PaintedMask::BlockParser {
public:
	explicit BlockParser(std::uint8_t background) : background_(background) {}

	/// Returns false if `to_bytes` could not have written these bytes.
	bool parse(ByteReader bytes, Blocks &r_blocks) {
		while (!bytes.at_end()) {
			const auto row = static_cast<std::int32_t>(bytes.take<std::uint32_t>());
			const auto column = static_cast<std::int32_t>(bytes.take<std::uint32_t>());
			const Key key{row, column};
			const bool ascends = r_blocks.empty() || r_blocks.rbegin()->first < key;
			const bool inside =
					row >= -block_limit && row < block_limit && column >= -block_limit && column < block_limit;
			std::shared_ptr<const Block> block = parse_block(bytes);
			if (!ascends || !inside || !block) {
				return false;
			}
			r_blocks.emplace_hint(r_blocks.end(), key, std::move(block));
		}
		return true;
	}

private:
	/// Returns null if the bytes are not a valid block.
	std::shared_ptr<const Block> parse_block(ByteReader &r_bytes) {
		const auto kind = r_bytes.take<std::uint8_t>();
		if (kind == static_cast<std::uint8_t>(BlockKind::uniform)) {
			const auto value = r_bytes.take<std::uint8_t>();
			return r_bytes.good() && value != background_ ? uniform(value) : nullptr;
		}
		const std::span<const std::uint8_t> pixels = r_bytes.take_bytes(std::tuple_size_v<Block>);
		if (kind != static_cast<std::uint8_t>(BlockKind::pixels) || pixels.empty() || is_uniform(pixels)) {
			return nullptr;
		}
		auto block = std::make_shared<Block>();
		std::memcpy(block->data(), pixels.data(), block->size());
		return block;
	}

	/// Returns one shared block for all blocks with only this value. Without sharing, each block
	/// would take 400 times as much memory as its encoding.
	std::shared_ptr<const Block> uniform(std::uint8_t value) {
		if (uniform_[value]) {
			// Blocks never change, so all uses of a value can share one block.
			return uniform_[value];
		}
		auto block = std::make_shared<Block>();
		block->fill(value);
		uniform_[value] = std::move(block);
		return uniform_[value];
	}

	std::uint8_t background_;
	std::array<std::shared_ptr<const Block>, 256> uniform_;
};

std::vector<std::uint8_t> PaintedMask::to_bytes() const {
	std::vector<std::uint8_t> bytes;
	append(bytes, magic);
	append(bytes, format_version);
	append(bytes, std::bit_cast<std::uint64_t>(pixel_size_));
	append(bytes, background_);
	for (const auto &[key, block] : blocks_) {
		append(bytes, static_cast<std::uint32_t>(key.first));
		append(bytes, static_cast<std::uint32_t>(key.second));
		const bool uniform = is_uniform(*block);
		append(bytes, static_cast<std::uint8_t>(uniform ? BlockKind::uniform : BlockKind::pixels));
		bytes.insert(bytes.end(), block->begin(), uniform ? block->begin() + 1 : block->end());
	}
	append(bytes, checksum(bytes));
	return bytes;
}

Status PaintedMask::from_bytes(std::span<const std::uint8_t> bytes) {
	constexpr Status corrupt{ErrorCode::corrupt, "data"};
	ByteReader reader(bytes);
	if (reader.take<std::uint32_t>() != magic) {
		return corrupt;
	}
	if (const auto version = reader.take<std::uint32_t>(); reader.good() && version != format_version) {
		return Status::out_of_range("version", version, exactly(format_version), newer_version);
	}
	if (bytes.size() < header_size + checksum_size) {
		return corrupt;
	}
	const std::span<const std::uint8_t> content = bytes.first(bytes.size() - checksum_size);
	if (ByteReader(bytes.last(checksum_size)).take<std::uint64_t>() != checksum(content)) {
		return corrupt;
	}
	const auto pixel_size = std::bit_cast<double>(reader.take<std::uint64_t>());
	const auto background = reader.take<std::uint8_t>();
	if (!check_range("pixel_size", pixel_size, min_pixel_size, max_pixel_size).ok()) {
		return corrupt;
	}
	return guarded("data", static_cast<double>(bytes.size()), [&]() -> Status {
		Blocks blocks;
		if (!BlockParser(background).parse(ByteReader(content.subspan(header_size)), blocks)) {
			return corrupt;
		}
		blocks_ = std::move(blocks);
		pixel_size_ = pixel_size;
		background_ = background;
		return {};
	});
}

} // namespace thicket
