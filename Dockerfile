# PeopleBoy as a command, with its kernels compiled; docs/tutorial/first-run.md says how it is used.
FROM python:3.11-slim AS built
COPY . /source
RUN pip wheel --no-cache-dir --no-deps --wheel-dir /wheel /source

FROM python:3.11-slim
COPY constraints.txt /
COPY --from=built /wheel /wheel
RUN pip install --no-cache-dir --constraint /constraints.txt "$(echo /wheel/*.whl)[export,meshes,viewer]"
# Whoever runs it may be anybody, and own nothing here.
ENV HOME=/tmp
# A container that is thrown away would compile each time anew.
RUN peopleboy run crossing_2 --seed 3 --out /warm && peopleboy report /warm && rm -r /warm
WORKDIR /work
ENTRYPOINT ["peopleboy"]
