#include "report/report.hpp"

namespace hybrid::report {
namespace {

std::string warning_lines(const nlohmann::ordered_json& registration) {
  std::string text;
  if (registration.contains("warnings"))
    for (const auto& warning : registration["warnings"])
      text += fmt::format("  warning: {}\n", warning.get<std::string>());
  return text;
}

std::string slide_line(const nlohmann::ordered_json& registration) {
  const auto& slide = registration["slide"];
  const auto free = registration["degenerate"][0].get<std::string>();
  if (slide["status"] != "accepted") return fmt::format("  {}: no other scan holds it there\n", free);
  return fmt::format("  {}: other scans hold it, {:.1f} mm from its start, sigma {:.1f} mm\n", free,
                     1000 * slide["shift_m"].get<double>(), 1000 * slide["sigma_m"].get<double>());
}

std::string scan_lines(const nlohmann::ordered_json& scan) {
  std::string text = fmt::format(
      "scan {}: {} measured samples, {} superclusters, {:.1f} % discarded\n", scan["id"].get<std::string>(),
      scan["decimation"]["measured"].get<std::int64_t>(), scan["superclusters"].get<std::int64_t>(),
      100 * scan["decimation"]["discarded_share"].get<double>());
  if (scan.contains("registration") && scan["registration"]["status"] == "abstained") {
    const auto& registration = scan["registration"];
    const bool on_scans = registration["how"] == "neighbour" ||
                          (registration.contains("refused") && registration["refused"].contains("on_scans"));
    text += !on_scans ? "  no pose: see sheet/ in the scan's folder\n"
            : registration.contains("places")
                ? "  no pose: no other scan places it; places.png shows where it may stand\n"
                : "  no pose: no other scan places it\n";
  } else if (scan.contains("registration")) {
    const auto& pose = scan["registration"];
    if (pose.contains("seen_through"))
      text += fmt::format("  {:.0f} % lie on other scans, rms {:.2f} mm; {:.1f} % are seen through\n",
                          100 * pose["overlap"].get<double>(), 1000 * pose["icp_rms_m"].get<double>(),
                          100 * pose["seen_through"].get<double>());
    if (pose.contains("icp_iterations"))
      text += fmt::format("  ICP rms {:.2f} mm after {} iterations\n", 1000 * pose["icp_rms_m"].get<double>(),
                          pose["icp_iterations"].get<int>());
    if (pose.contains("aligned_to"))
      text += fmt::format("  aligned to scan {}\n", pose["aligned_to"].get<std::string>());
    if (pose.contains("recorded"))
      text += fmt::format("  {} its file's pose beside scan {}\n",
                          pose["recorded"].contains("kept") ? "stays at" : "from",
                          pose["recorded"]["beside"].get<std::string>());
    if (pose.contains("slide")) text += slide_line(pose);
    if (pose.contains("wall_after_icp")) {
      const auto& before = pose["wall_before_icp"];
      const auto& after = pose["wall_after_icp"];
      text += fmt::format(
          "  wall samples within 5 / 10 cm of the proxy: {:.1f} / {:.1f} % before ICP, {:.1f} / {:.1f} % "
          "after\n",
          100 * before["within_5cm"].get<double>(), 100 * before["within_10cm"].get<double>(),
          100 * after["within_5cm"].get<double>(), 100 * after["within_10cm"].get<double>());
    }
    if (pose.contains("faces") && pose["faces"]["solved_with_the_pose"])
      text += fmt::format("  the proxy's faces are off by {:.1f} mm (1 sigma): solved with the pose\n",
                          1000 * pose["faces"]["disagreement_m"].get<double>());
  }
  if (scan.contains("registration")) text += warning_lines(scan["registration"]);
  if (scan.contains("truth")) {
    const auto& truth = scan["truth"];
    text += fmt::format(
        "  against truth: {:.2f} % of planar samples right, {} of {} planes found, {:.2f} % of curved "
        "samples called planar\n",
        100 * truth["planar_samples_right_share"].get<double>(), truth["planes_found"].get<int>(),
        truth["planes_of_100_samples"].get<int>(), 100 * truth["curved_called_planar_share"].get<double>());
    if (truth.contains("pose_error_mm"))
      text += fmt::format("  pose error {:.3f} mm, {:.4f} deg\n", truth["pose_error_mm"].get<double>(),
                          truth["pose_error_deg"].get<double>());
  }
  return text;
}

}  // namespace

std::string text_summary(const batch::SceneRun& run, const std::filesystem::path& out) {
  std::string text;
  for (const auto& scan : run.summary["scans"]) text += scan_lines(scan);
  if (run.summary.contains("joint"))
    for (const auto& pair : run.summary["joint"]["pairs"])
      text += fmt::format(
          "scans {} - {}: overlap {:.0f} %, distance {:.2f} mm (before {:.2f}), strength {:.0f} %\n",
          pair["a"].get<std::string>(), pair["b"].get<std::string>(), 100 * pair["overlap"].get<double>(),
          1000 * pair["distance_m"].get<double>(), 1000 * pair["distance_before_m"].get<double>(),
          100 * pair["strength"].get<double>());
  for (const auto& view : run.summary["views"])
    if (view.contains("left_out"))
      text += fmt::format(
          "view {}: {} from the other photographs: PSNR {:.2f} dB, SSIM {:.3f} on {:.1f} % of its pixels\n",
          view["name"].get<std::string>(), view["left_out"]["photograph"].get<std::string>(),
          view["left_out"]["psnr_db"].get<double>(), view["left_out"]["ssim"].get<double>(),
          100 * view["left_out"]["share_seen"].get<double>());
  if (run.summary.contains("leave_one_out")) {
    const auto& mean = run.summary["leave_one_out"]["mean"];
    text += fmt::format(
        "mean of {} photographs left out: PSNR {:.2f} dB, SSIM {:.3f} on {:.1f} % of their pixels\n",
        run.summary["leave_one_out"]["photographs"].size(), mean["psnr_db"].get<double>(),
        mean["ssim"].get<double>(), 100 * mean["share_seen"].get<double>());
  }
  for (const auto& failure : run.failures)
    text += fmt::format("failed: {}\n  run it again: {}\n", failure.error, failure.command);
  return text + fmt::format("results: {}\n", out.string());
}

}  // namespace hybrid::report
