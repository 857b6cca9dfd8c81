// SPDX-License-Identifier: Apache-2.0
#include "reader.hpp"
#include "resight/viewer/internal/parse_request.hpp"
#include "resight/viewer/viewer_routes.hpp"

/// Requests to the server of `resight view` and `resight annotate`, from the bytes to the answer. Exceptions of the
/// handler are findings here, although the server would answer them.
namespace resight::fuzz {
namespace {

namespace fs = std::filesystem;
using Seeds = std::vector<std::string>;

constexpr const char* kToken = "0";
constexpr int kMaxRevision = 25;  // Then the project begins anew.

/// Two views of a wall.
class WallViews : public Sequence {
 public:
  [[nodiscard]] std::string format() const override { return "fuzz"; }
  [[nodiscard]] int num_views() const override { return 2; }
  [[nodiscard]] std::string view_name(int view) const override { return view == 0 ? "000000" : "000001"; }
  [[nodiscard]] Result<RgbdFrame> read_view(int view) const override {
    RgbdFrame frame;
    frame.name = view_name(view);
    frame.camera = {64, 48, 60, 60, 31.5, 23.5};
    frame.color = Image<Rgb8>(64, 48, Rgb8{200, 100, 50});
    frame.depth_m = Image<float>(64, 48, 1.0F);
    return frame;
  }
  [[nodiscard]] Result<Rigid3> read_pose(int) const override { return Rigid3(); }
};

std::shared_ptr<const ModelLibrary> make_plate_library() {
  auto library = std::make_shared<ModelLibrary>();
  ObjectModel plate;
  plate.name = "plate";
  plate.bop_id = 1;
  for (int i = 0; i < 400; ++i) {
    plate.surface.points.emplace_back(0.01F * static_cast<float>(i % 20), 0.01F * static_cast<float>(i / 20), 0.0F);
    plate.surface.normals.emplace_back(0.0F, 0.0F, -1.0F);
    plate.surface.colors.push_back({200, 100, 50});
  }
  plate.center = {0.1F, 0.1F, 0};
  plate.diameter_m = 0.27F;
  plate.symmetries.discrete.push_back(Rigid3::from_axis_angle({0, 0, 1}, 3.14159265));
  library->objects.push_back(plate);
  library->surface_voxel_m = 0.01F;
  return library;
}

/// A viewer and an annotation, as the program makes them.
class Site {
 public:
  Site() : views_(std::make_shared<WallViews>()), library_(make_plate_library()) {
    ViewerScene scene;
    scene.title = "fuzz";
    scene.sequence = views_;
    scene.library = library_;
    scene.is_annotated = true;
    StoredView view;
    view.name = "000000";
    view.detections.push_back({});
    view.detections.back().object = "plate";
    scene.runs.push_back({"run", {}});
    scene.runs.back().results.views.push_back(view);
    data_ = SceneData::create(std::move(scene)).value();
    begin();
  }
  void answer(const HttpRequest& request) {
    (void)handler_(request);
    if (service_->project().revision() > kMaxRevision) begin();
  }

  [[nodiscard]] int revision() const { return service_->project().revision(); }

 private:
  void begin() {
    service_.reset();
    fs::remove_all(scratch_folder() / "site");
    AnnotationTask task;
    task.sequence = views_;
    task.library = library_;
    ChangeProposal region;
    region.view = 1;
    region.box.size_m = {0.1, 0.1, 0.1};
    region.points_in_world = {{0, 0, 1}};
    region.pixels = {{5, 10}, {70, 10}};
    task.regions.push_back(region);
    task.project =
        AnnotationProject::open(scratch_folder() / "site", {.num_views = 2, .num_objects = 1}, "fuzz").value();
    task.scene_name = "fuzz";
    task.export_folder = scratch_folder() / "site" / "export";
    service_ = std::make_unique<AnnotationService>(std::move(task));
    handler_ = make_viewer_handler(*data_, kToken, service_.get());
  }
  std::shared_ptr<const Sequence> views_;
  std::shared_ptr<const ModelLibrary> library_;
  std::unique_ptr<SceneData> data_;
  std::unique_ptr<AnnotationService> service_;
  HttpHandler handler_;
};

std::string make_get(const std::string& path) {
  return "GET " + path + " HTTP/1.1\r\nHost: localhost:1\r\nX-Resight-Token: " + kToken + "\r\n\r\n";
}
std::string make_post(const std::string& path, const std::string& body) {
  return "POST /api/annotation/" + path + " HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Resight-Token: " + kToken +
         "\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
}
std::string make_action(const std::string& change) {
  return R"({"revision":0,"action":{"title":"t","changes":[)" + change + "]}}";
}

/// What is posted to the annotation: the last part of the address, a line break, and the body.
Seeds make_annotation_seeds() {
  const std::string pose = "[1,0,0,0,0,1,0,0,0,0,1,0,0,0,1,1]";
  return {
      "actions\n" + make_action(R"({"do":"put_object","object":0,"first_view":0,"last_view":1,"pose":)" + pose + "}"),
      "actions\n" + make_action(R"({"do":"judge_region","region":{"view":1,"kind":"novel","center":[0,0,0]},)"
                                R"("verdict":"accepted","track":0,"mask":[3,4,9,1]},{"do":"check_view","view":1,)"
                                R"("is_checked":true})"),
      "actions\n" + make_action(R"({"do":"put_event","view":1,"kind":"moved","name":"box","before":[0,0,0],)"
                                R"("after":[1,2,3]},{"do":"drop_event","id":0},{"do":"drop_object","id":0})"),
      "actions\n"
      R"({"revision":0,"action":"undo"})",
      "place\n"
      R"({"object":0,"view":0,"u":30,"v":20})",
      "refine\n"
      R"({"object":0,"first_view":0,"last_view":1,"all_turns":true,"pose":)" +
          pose + "}",
      "assess\n"
      R"({"object":0,"pose":)" +
          pose + "}",
      "export\n{}",
  };
}

Seeds make_request_seeds() {
  Seeds seeds;
  for (const char* path :
       {"/", "/viewer.css", "/api/scene", "/api/events", "/api/views/1", "/api/views/0?run=0", "/api/views/0/color",
        "/api/views/0/depth", "/api/views/0/trace?run=0", "/api/surfaces/0", "/api/annotation",
        "/api/annotation/views/1", "/api/annotation/symmetries/0", "/api/annotation/regions/0"})
    seeds.push_back(make_get(path));
  for (const std::string& posted : make_annotation_seeds()) {
    const std::size_t end = posted.find('\n');
    seeds.push_back(make_post(posted.substr(0, end), posted.substr(end + 1)));
  }
  seeds.push_back(
      "POST /api/annotation/export HTTP/1.1\r\nHost: [::1]\r\nX-Resight-Token: 0\r\n"
      "Transfer-Encoding: chunked\r\n\r\n2\r\n{}\r\n0\r\n\r\n");
  return seeds;
}

Site& shared_site() {
  static Site site;
  return site;
}

void read_request(std::string_view bytes) {
  if (const auto request = viewer::parse_request(bytes)) shared_site().answer(*request);
}

/// Posts a body to the annotation. An action on revision 0 becomes one on the current revision, so that it is applied.
void read_annotation_request(std::string_view bytes) {
  const std::size_t end = std::min(bytes.find('\n'), bytes.size());
  HttpRequest request;
  request.method = "POST";
  request.path = "/api/annotation/" + std::string(bytes.substr(0, end));
  request.host = "localhost";
  request.token = kToken;
  request.body = std::string(bytes.substr(std::min(end + 1, bytes.size())));
  constexpr std::string_view kBasedOn = "\"revision\":0";
  if (const std::size_t at = request.body.find(kBasedOn); at != request.body.npos)
    request.body.replace(at, kBasedOn.size(), "\"revision\":" + std::to_string(shared_site().revision()));
  shared_site().answer(request);
}

}  // namespace

std::vector<FuzzReader> http_readers() {
  return {{"http_request", make_request_seeds, read_request},
          {"annotation_request", make_annotation_seeds, read_annotation_request, 1000}};
}

}  // namespace resight::fuzz
