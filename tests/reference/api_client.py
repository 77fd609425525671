"""A whole job through a client that openapi-python-client makes of a service's description.

python api_client.py URL CASE FOLDER: makes the client in FOLDER, submits the case, waits for its end and writes a_n.csv there. Every
answer is held against its schema as well, since a client takes more than it was promised.
"""

import importlib
import subprocess
import sys
import time
from pathlib import Path

import httpx
import jsonschema

url, case, folder = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3])
made = [sys.executable, "-m", "openapi_python_client", "generate", "--meta", "none", "--overwrite"]
made += ["--url", f"{url}/openapi.json", "--output-path", str(folder / "perilife_client")]
output = subprocess.run(made, capture_output=True, text=True)
assert output.returncode == 0, output.stdout + output.stderr
print(output.stdout)
sys.path.insert(0, str(folder))
client_module = importlib.import_module("perilife_client")
models = importlib.import_module("perilife_client.models")
description = httpx.get(f"{url}/openapi.json").json()


def operation(tag, name):
    return importlib.import_module(f"perilife_client.api.{tag}.{name}")


def keeps(path, response):
    """Whether an answer has the form that is described."""
    content = description["paths"][path]["get"]["responses"][str(response.status_code)]["content"]
    schema = content[response.headers["content-type"].partition(";")[0]].get("schema", {})
    jsonschema.validate(response.json(), {**schema, "components": description["components"]})


client = client_module.Client(base_url=url)
predictions = models.Collection.PREDICTIONS
body = models.JobRequest(input_=case.read_text(), name=case.stem)
job = operation("jobs", "submit").sync(predictions, client=client, body=body)
assert isinstance(job, models.JobView), job
looks = 0
while job.state in (models.State.QUEUED, models.State.RUNNING):
    assert looks < 2000, job
    looks += 1
    time.sleep(0.05)
    job = operation("jobs", "show").sync(predictions, job.id, client=client)
    keeps("/v1/{collection}/{id}", httpx.get(f"{url}/v1/predictions/{job.id}"))
assert job.state == models.State.SUCCEEDED, job
listed = operation("jobs", "list_").sync(predictions, client=client, limit=5, state=models.State.SUCCEEDED)
assert [item.id for item in listed.items] == [job.id]
curve = operation("results", "file").sync(predictions, job.id, "a_n.csv", client=client).payload.read()
(folder / "a_n.csv").write_bytes(curve)
left = operation("results", "remaining").sync(job.id, client=client, crack_length_mm=20.0)
assert left.inspection_interval_cycles > 0, left

# What is not found, and what is wrong, come as what the description says.
missing = operation("jobs", "show").sync(predictions, "no", client=client)
assert isinstance(missing, models.Problem) and missing.status == 404, missing
wrong = operation("jobs", "submit").sync(predictions, client=client, body=models.JobRequest(input_="[specimen]"))
assert isinstance(wrong, models.Problem) and wrong.status == 422, wrong

for path, query in [
    ("/v1/service", ""),
    ("/v1/kinds", ""),
    ("/v1/materials", ""),
    ("/v1/{collection}", ""),
    ("/v1/{collection}", "?limit=0"),
    ("/v1/{collection}/{id}", ""),
    ("/v1/predictions/{id}/remaining", "?crack_length_mm=20"),
    ("/v1/predictions/{id}/remaining", "?crack_length_mm=1"),
]:
    keeps(path, httpx.get(url + path.replace("{collection}", "predictions").replace("{id}", job.id) + query))
print(f"{job.state} after {looks} looks, {len(curve)} bytes of a_n.csv, {left.remaining_cycles:.0f} cycles left at 20 mm")
