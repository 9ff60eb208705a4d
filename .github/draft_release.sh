#!/usr/bin/env bash
# Drafts the release of the tag $GITHUB_REF_NAME, with the files of tools/package.sh in a folder: the zips, their checksums, the libraries
# with symbols, and notes from CHANGELOG.md. The Python packages from the folder are added. Needs GitHub's program gh and its token in $GH_TOKEN.
#   bash .github/draft_release.sh build/dist
set -euo pipefail
folder=$(cd "${1:?the folder with the zips}" && pwd)
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."

tag=${GITHUB_REF_NAME:?the tag of the release}
(cd "$folder" && sha256sum --check --quiet SHA256SUMS)
notes=$(mktemp)
python3 tools/package/notes.py "$tag" >"$notes"
tar --create --xz --file "$folder/thicket-symbols-${tag#v}.tar.xz" --directory "$folder" symbols
gh release create "$tag" --draft --verify-tag --title "Thicket ${tag#v}" --notes-file "$notes" \
	"$folder"/thicket-*.zip "$folder"/poissontiles-* "$folder/thicket-symbols-${tag#v}.tar.xz" "$folder/SHA256SUMS"
