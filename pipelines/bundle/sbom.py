"""Prints what the program of bundle.sh contains, as SPDX 2.3 JSON: sbom.py COMPONENTS SOURCES VERSION"""

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


def package(name: str, version: str, licence: str) -> Dict[str, object]:
    return {"name": name, "SPDXID": "SPDXRef-" + "".join(c if c.isalnum() else "-" for c in name),
            "versionInfo": version, "downloadLocation": "NOASSERTION", "filesAnalyzed": False,
            "licenseConcluded": licence, "licenseDeclared": licence, "copyrightText": "NOASSERTION"}


def main() -> None:
    components, sources, version = sys.argv[1:]
    packages: List[Dict[str, object]] = [package("ngs", version, "Apache-2.0")]
    with open(components, encoding="utf-8") as file:
        rows = [line.split() for line in file if not line.startswith("#")]
    for name, *licence, origin in rows:
        source, found = debian_version(name, origin, sources)
        row = package(name, found, " ".join(licence))
        row["supplier"] = "Organization: Debian"
        row["externalRefs"] = [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl",
                                "referenceLocator": f"pkg:deb/debian/{source}@{found}?arch=source"}]
        packages.append(row)
    relations = [{"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES",
                  "relatedSpdxElement": packages[0]["SPDXID"]}]
    relations += [{"spdxElementId": packages[0]["SPDXID"], "relationshipType": "CONTAINS",
                   "relatedSpdxElement": row["SPDXID"]} for row in packages[1:]]
    digest = hashlib.sha256(json.dumps(packages).encode()).hexdigest()
    when = datetime.datetime.fromtimestamp(int(os.environ["SOURCE_DATE_EPOCH"]), datetime.timezone.utc)
    json.dump({"spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT", "name": f"ngs-{version}",
               "documentNamespace": f"https://spdx.org/spdxdocs/ngs-{version}-{digest}",
               "creationInfo": {"created": when.strftime("%Y-%m-%dT%H:%M:%SZ"), "creators": ["Tool: ngs-bundle"]},
               "packages": packages, "relationships": relations}, sys.stdout, indent=1)
    print()


if __name__ == "__main__":
    main()
