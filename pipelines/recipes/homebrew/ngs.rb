# Draft, untested.
class Ngs < Formula
  desc "Cuts objects out of 3D Gaussian splatting scenes"
  homepage "@URL@"
  url "@URL@/ngs-@VERSION@-linux-x86_64.tar.xz"
  sha256 "@LINUX_SHA256@"
  license "Apache-2.0"

  depends_on arch: :x86_64
  depends_on :linux

  def install
    prefix.install Dir["*"]
  end

  test do
    system bin/"ngs-synth", "two-spheres", "-o", "scene", "--view-count", "4", "--width-px", "96", "--height-px", "72",
           "--fit-steps", "60"
    system bin/"ngs", "cut", "scene", "--quality", "draft", "-o", "cut"
    assert_path_exists testpath/"cut/object.ply"
  end
end
