"""Prints what the program of bundle.sh contains, as SPDX 2.3 JSON: sbom.py SOURCES VERSION COMPONENTS..."""

import datetime
import glob
import hashlib
import json
import os
import subprocess
import sys
from typing import Dict, List, Tuple


def debian_version(name: str, origin: str, sources: str) -> Tuple[str, str]:
    """Name and version of Debian's source package."""
    if origin != "source":
        fields = subprocess.check_output(
            ["dpkg-query", "-W", "-f=${source:Package} ${source:Version}", origin], text=True).split()
        return fields[0], fields[1]
    dsc, = glob.glob(os.path.join(sources, name, "*.dsc"))
    with open(dsc, encoding="utf-8") as file:
        return name, next(line.split()[1] for line in file if line.startswith("Version:"))


def text_of(*path: str) -> str:
    with open(os.path.join(*path), encoding="utf-8") as file:
        return file.read()


def origin_of(name: str, origin: str, sources: str) -> Tuple[str, str, str]:
    """Version, supplier and address (purl)."""
    if origin == "cuda":
        version = text_of(sources, name, "version").strip()
        return version, "NVIDIA", f"pkg:generic/nvidia/{name}@{version}"
    source, version = debian_version(name, origin, sources)
    return version, "Debian", f"pkg:deb/debian/{source}@{version}?arch=source"


def package(name: str, version: str, licence: str) -> Dict[str, object]:
    return {"name": name, "SPDXID": "SPDXRef-" + "".join(c if c.isalnum() else "-" for c in name),
            "versionInfo": version, "downloadLocation": "NOASSERTION", "filesAnalyzed": False,
            "licenseConcluded": licence, "licenseDeclared": licence, "copyrightText": "NOASSERTION"}


def main() -> None:
    sources, version, *components = sys.argv[1:]
    packages: List[Dict[str, object]] = [package("ngs", version, "Apache-2.0")]
    rows = [line.split() for file in components for line in text_of(file).splitlines() if not line.startswith("#")]
    extracted = []  # licences without a name in SPDX's list
    for name, *licence, origin in rows:
        found, supplier, address = origin_of(name, origin, sources)
        row = package(name, found, " ".join(licence))
        row["supplier"] = "Organization: " + supplier
        row["externalRefs"] = [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl",
                                "referenceLocator": address}]
        packages.append(row)
        if licence[0].startswith("LicenseRef-"):
            extracted.append({"licenseId": licence[0], "extractedText": text_of(sources, name, "licence")})
    relations = [{"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES",
                  "relatedSpdxElement": packages[0]["SPDXID"]}]
    relations += [{"spdxElementId": packages[0]["SPDXID"], "relationshipType": "CONTAINS",
                   "relatedSpdxElement": row["SPDXID"]} for row in packages[1:]]
    digest = hashlib.sha256(json.dumps(packages).encode()).hexdigest()
    when = datetime.datetime.fromtimestamp(int(os.environ["SOURCE_DATE_EPOCH"]), datetime.timezone.utc)
    document = {"spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT", "name": f"ngs-{version}",
               "documentNamespace": f"https://spdx.org/spdxdocs/ngs-{version}-{digest}",
               "creationInfo": {"created": when.strftime("%Y-%m-%dT%H:%M:%SZ"), "creators": ["Tool: ngs-bundle"]},
               "packages": packages, "relationships": relations}
    if extracted:
        document["hasExtractedLicensingInfos"] = extracted
    json.dump(document, sys.stdout, indent=1)
    print()


if __name__ == "__main__":
    main()
