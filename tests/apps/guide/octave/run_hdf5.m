% Runs hdf5.py, which finds or leaves `data` in a file.
function data = run_hdf5(action, file, names, data)
  save('-v6', 'exchange.mat', 'data');
  script = fullfile(fileparts(mfilename('fullpath')), 'hdf5.py');
  assert(system(sprintf('python3 %s %s %s %s exchange.mat', script, action, file, names)) == 0);
  data = load('exchange.mat').data;
end
